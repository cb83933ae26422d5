/* An FMU driven from C and linked with its sources, in any version of FMI. The inputs depend on the variant. */
#ifndef SH_TEST_DRIVE_H
#define SH_TEST_DRIVE_H

#include <math.h>

#include "fmi_calls.h"

/* Makes step number k, of 1 ms. */
static inline void step(void *instance, int variant, long k)
{
    const double t = (double)k * 1e-3;
    uint32_t i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const double frequency = 5.0 + i + variant;
        const double value = 0.3 * sin(frequency * t), slope = 0.3 * frequency * cos(frequency * t);

        if (sh_fmu_model.variables[i].role != SH_ROLE_INPUT) {
            continue;
        }
        check(fmi_set_reals(instance, &i, 1, &value) == SH_OK, "set an input");
        check(fmi_set_slope(instance, i, slope) == SH_OK, "set the derivative of an input");
    }
    check(fmi_do_step(instance, t, 1e-3) == SH_OK, "step");
}

/* Real outputs [size: at most 256]. */
static inline void get_outputs(void *instance, double *values)
{
    uint32_t i;
    size_t n = 0;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        if (variable->type != SH_TYPE_REAL ||
            (variable->role != SH_ROLE_OUTPUT && variable->role != SH_ROLE_GUESS)) {
            continue;
        }
        check(n < 256, "more than 256 outputs");
        check(fmi_get_reals(instance, &i, 1, &values[n++]) == SH_OK, "get an output");
    }
}

#endif
