/* A sequence of FMI calls with arguments of any kind, chosen by the bytes of a fuzzer.
 *
 * fuzz.c and fuzz_states.c make the calls that every version of FMI has, fuzz_fmi2.c or fuzz_fmi3.c
 * those of one version, and fuzz_arguments.c the arguments. Most of these are valid, because else no
 * sequence would get past its first calls.
 */
#ifndef SH_TEST_FUZZ_H
#define SH_TEST_FUZZ_H

#include <stddef.h>
#include <stdint.h>

#include "model.h"

enum { SLOTS = 3, MAX_REFERENCES = 6, TEXT = 16 };

typedef struct {
    const uint8_t *next, *end; /* the remaining bytes of the fuzzer */
    void *instance;
    void *states[SLOTS];
    double stop_times[SLOTS]; /* of the states */
    double time;              /* next communication point */
    double stop_time;         /* infinite if there is none */
    double longest_step;      /* of all steps so far */
    int forged;               /* 1: a forged state was taken; its stop time is unknown */
} sequence;

/* The next byte; 0 when there are no more bytes. */
unsigned byte(sequence *s);
unsigned below(sequence *s, unsigned n);
/* 1 in one of n cases; 0 when there are no more bytes. */
int seldom(sequence *s, unsigned n);
uint64_t bits(sequence *s);

/* A double: mostly about as large as `size`, sometimes any number. */
double some_real(sequence *s, double size);
int some_integer(sequence *s);
/* A text of up to TEXT - 1 bytes of any kind, or NULL. */
const char *some_text(sequence *s, char *text);

/* Up to MAX_REFERENCES value references, mostly of the types (bits SH_TYPE_*) and of the roles
 * first to last.
 */
size_t some_references(sequence *s, uint32_t *references, unsigned types, sh_role first,
                       sh_role last);

/* Memory of exactly this size, so that a sanitizer sees what goes beyond; at least 1 byte. */
void *memory(size_t size);

/* Checks what the logger of the importer receives. */
void check_message(int status, const char *category, const char *message);

/* Saves, restores, frees or serialises one of the states. */
void use_states(sequence *s);

/* Each version has its own. */
void *some_instance(sequence *s);
void set_integers(sequence *s);
void get_integers(sequence *s);
void call_of_this_version(sequence *s);

#endif
