#include "shell_importer.h"

#include <stdlib.h>
#include <string.h>

#include "__fc_builtin.h"

static volatile int unknown_int;
static volatile double unknown_real;

int any_choice(void)
{
    return Frama_C_interval(0, 1);
}

int any_int(void)
{
    return unknown_int;
}

size_t any_size(void)
{
    return Frama_C_size_t_interval(0, SIZE_MAX);
}

double any_real(void)
{
    return unknown_real;
}

const char *any_text(void)
{
    static char text[16];

    Frama_C_make_unknown(text, sizeof text - 1);
    return text;
}

void *any_bytes(size_t size)
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

void *allocate(size_t count, size_t size)
{
    return any_choice() ? any_bytes(count * size) : NULL;
}

void release(void *memory)
{
    free(memory);
}
