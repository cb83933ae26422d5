/* An importer that may do anything which FMI allows, for the proof of the shell by Frama-C Eva.
 *
 * Eva computes with sets of values: a call of a function here returns all values that it can return.
 */
#ifndef SHELL_IMPORTER_H
#define SHELL_IMPORTER_H

#include <stdint.h>
#include <stdlib.h>

#include "__fc_builtin.h"
#include "instance.h"

static volatile int any_int_at_all;
static volatile double any_real_at_all; /* infinities and NaN, too */

/* 0 or 1. */
static int any_choice(void)
{
    return Frama_C_interval(0, 1);
}

static int any_int(void)
{
    return any_int_at_all;
}

static size_t any_size(void)
{
    return Frama_C_size_t_interval(0, SIZE_MAX);
}

static double any_real(void)
{
    return any_real_at_all;
}

/* At most 15 bytes of any value, then 0. */
static const char *any_text(void)
{
    static char text[16];

    Frama_C_make_unknown(text, sizeof text - 1);
    return text;
}

/* Memory of exactly this size with any bytes. */
static void *any_bytes(size_t size)
{
    char *bytes = malloc(size);

    if (bytes == NULL) { /* what cannot be handed over is not */
        Frama_C_abort();
    }
    if (size > 0) {
        Frama_C_make_unknown(bytes, size);
    }
    return bytes;
}

/* Allocation by the importer: NULL, or memory with any bytes. */
static void *allocate(size_t count, size_t size)
{
    return any_choice() ? any_bytes(count * size) : NULL;
}

static void release(void *memory)
{
    free(memory);
}

#endif
