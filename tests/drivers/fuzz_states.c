#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

enum { CHECKSUM = 120 }; /* its place in a serialised state, behind the rest of the header */

/* Writes the right checksum, as anybody can who has the sources: FNV-1a over all bytes but its own. */
static void sign(uint8_t *bytes, size_t size)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    size_t i;

    memset(bytes + CHECKSUM, 0, sizeof hash);
    for (i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    }
    memcpy(bytes + CHECKSUM, &hash, sizeof hash);
}

/* Changes some numbers of a state, so that only what they mean can show it. */
static void forge(sequence *s, uint8_t *bytes, size_t size)
{
    static const double REALS[] = {NAN, INFINITY, -INFINITY, -1.0, 1e300, -1e300, 5e-324, 0.0};
    unsigned changes;

    for (changes = 1 + below(s, 4); changes > 0; --changes) {
        /* The first part has more choices than the rest, which is mostly large matrices. */
        const size_t place = bits(s) % (below(s, 2) ? size : 4096) % size & ~(size_t)3;
        const double real = REALS[below(s, sizeof REALS / sizeof REALS[0])];
        const int integer = below(s, 2) ? (int)below(s, 80) - 8 : some_integer(s);
        const int is_real = place % 8 == 0 && below(s, 2) && place + sizeof real <= size;

        memcpy(bytes + place, is_real ? (const void *)&real : (const void *)&integer,
               is_real ? sizeof real : sizeof integer);
    }
    sign(bytes, size);
}

/* Lets the instance go on from a forged state, if it is taken. */
static void use_forged(sequence *s, void *state)
{
    size_t size = 0;
    uint8_t *bytes;
    void *copy = NULL;

    if (fmi_state_size(s->instance, state, &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    check(fmi_serialize_state(s->instance, state, bytes, size) == SH_OK,
          "a good state was not serialised");
    forge(s, bytes, size);
    if (fmi_deserialize_state(s->instance, bytes, size, &copy) == SH_OK) {
        check(fmi_set_state(s->instance, copy) == SH_OK, "a state was taken, and then refused");
        s->stop_time = INFINITY; /* the state may have another one, which nobody knows */
        s->forged = 1;
        s->time = fmi_time(s->instance, s->time);
    }
    fmi_free_state(s->instance, &copy);
    free(bytes);
}

/* Serialises a state, maybe damages it, and reads it back. */
static void serialise(sequence *s, void **state)
{
    void *copy = NULL;
    sh_status status;
    uint8_t *bytes;
    size_t size = 0, length;
    int damaged = 0;

    if (fmi_state_size(s->instance, *state, &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    if (seldom(s, 16)) {
        check(fmi_serialize_state(s->instance, *state, bytes, size - 1) == SH_ERROR,
              "a state went into too little room");
    }
    check(fmi_serialize_state(s->instance, *state, bytes, size) == SH_OK,
          "a good state was not serialised");
    length = size;
    if (below(s, 2)) {
        const unsigned flip = byte(s);
        bytes[bits(s) % size] ^= (uint8_t)flip;
        damaged = flip != 0;
    }
    if (seldom(s, 4)) { /* truncated, in a block of exactly this size */
        length = (below(s, 2) ? bits(s) : byte(s)) % size;
        bytes = realloc(bytes, length > 0 ? length : 1);
        check(bytes != NULL, "out of memory");
    }
    status = fmi_deserialize_state(s->instance, bytes, length, &copy);
    check(status == SH_ERROR || (!damaged && length == size), "a spoilt state was taken");
    if (status == SH_OK) {
        fmi_free_state(s->instance, state);
        *state = copy;
    }
    free(bytes);
}

static void restore(sequence *s, unsigned slot)
{
    unsigned char *block = s->states[slot];

    if (block != NULL && seldom(s, 32)) {
        unsigned char *place = block + below(s, 12); /* of what says whose state it is */
        *place ^= 1;
        check(fmi_set_state(s->instance, block) == SH_ERROR, "a foreign state was taken");
        *place ^= 1;
    }
    if (fmi_set_state(s->instance, block) == SH_OK) {
        s->stop_time = s->stop_times[slot];
        s->time = fmi_time(s->instance, s->time);
    }
}

void use_states(sequence *s)
{
    const unsigned slot = below(s, SLOTS);

    switch (below(s, 7)) {
    case 0:
    case 1:
        if (fmi_get_state(s->instance, &s->states[slot]) == SH_OK) {
            s->stop_times[slot] = s->stop_time;
        }
        break;
    case 2:
        restore(s, slot);
        break;
    case 3:
        fmi_free_state(s->instance, &s->states[slot]);
        break;
    case 4:
    case 5:
        use_forged(s, s->states[slot]);
        break;
    default:
        serialise(s, &s->states[slot]);
    }
}
