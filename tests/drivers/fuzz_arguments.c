#include "fuzz.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

unsigned byte(sequence *s)
{
    return s->next < s->end ? *s->next++ : 0;
}

unsigned below(sequence *s, unsigned n)
{
    return byte(s) % n;
}

int seldom(sequence *s, unsigned n)
{
    return byte(s) % n == n - 1;
}

uint64_t bits(sequence *s)
{
    uint64_t all = 0;
    int i;

    for (i = 0; i < 8; ++i) {
        all = all << 8 | byte(s);
    }
    return all;
}

double some_real(sequence *s, double size)
{
    static const double ODD[] = {0.0,  -0.0,     1.0,     -1.0,    NAN,    INFINITY,
                                 1e12, -1e13,    DBL_MAX, DBL_MIN, 5e-324, -INFINITY,
                                 1e-9, -DBL_MAX, 1e300,   1e-300};
    const unsigned choice = byte(s);
    uint64_t pattern;
    double value;

    if (choice < 16) {
        return ODD[choice];
    }
    if (choice == 16) {
        pattern = bits(s);
        memcpy(&value, &pattern, sizeof value);
        return value;
    }
    value = (size != 0.0 ? size : 1.0) * ((double)byte(s) + 1.0) / 128.0;
    return choice < 64 ? -value : value;
}

int some_integer(sequence *s)
{
    static const int ODD[] = {INT32_MAX, INT32_MIN, -1, 0, 100};

    return seldom(s, 8) ? ODD[below(s, 5)] : 1 + (int)below(s, 3);
}

const char *some_text(sequence *s, char *text)
{
    size_t i, length = below(s, TEXT + 1);

    if (length == TEXT) {
        return NULL;
    }
    for (i = 0; i < length; ++i) {
        text[i] = (char)byte(s);
    }
    text[length] = '\0';
    return text;
}

size_t some_references(sequence *s, uint32_t *references, unsigned types, sh_role first,
                       sh_role last)
{
    const size_t n = below(s, MAX_REFERENCES + 1);
    size_t i, k;

    for (i = 0; i < n; ++i) {
        references[i] = (byte(s) << 1 | (byte(s) & 1)) % (unsigned)sh_fmu_model.count;
        for (k = 0; k < sh_fmu_model.count; ++k) {
            const sh_variable *variable = &sh_fmu_model.variables[references[i]];
            if (((unsigned)variable->type & types) && variable->role >= first &&
                variable->role <= last) {
                break;
            }
            references[i] = (uint32_t)((references[i] + 1) % sh_fmu_model.count);
        }
        if (seldom(s, 128)) {
            references[i] = (uint32_t)bits(s);
        }
    }
    return n;
}

void *memory(size_t size)
{
    void *allocated = malloc(size > 0 ? size : 1);

    check(allocated != NULL, "out of memory");
    return allocated;
}
