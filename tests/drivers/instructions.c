/* instructions SUBJECT N: runs N times what tests/project/test_instructions.py counts.
 *
 * With -DSH_PLANT the program has a plant, and "step" alone.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

enum { MOST_INPUTS = 16 };

/* Steps of an FMU: its Real inputs are set in one call, and one output is read. */
static void steps(long count)
{
    uint32_t inputs[MOST_INPUTS], output = 0, i;
    double values[MOST_INPUTS], read;
    void *instance = start();
    size_t n = 0;
    long k;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        if (sh_fmu_model.variables[i].role == SH_ROLE_INPUT && n < MOST_INPUTS) {
            inputs[n++] = i;
        }
        output = sh_fmu_model.variables[i].role == SH_ROLE_OUTPUT && output == 0 ? i : output;
    }
    for (k = 0; k < count; ++k) {
        for (i = 0; i < n; ++i) {
            values[i] = 1e-3 * (double)((7 * k + 3 * i) % 100);
        }
        check(fmi_set_reals(instance, inputs, n, values) == SH_OK, "set the inputs");
        check(fmi_do_step(instance, (double)k * 1e-3, 1e-3) == SH_OK, "step");
        check(fmi_get_reals(instance, &output, 1, &read) == SH_OK, "get an output");
    }
}

#ifndef SH_PLANT
#include "least_squares.h"
#include "sigmahat.h"

static void least_squares(long count)
{
    sh_least_squares rls;
    sh_innovation innovation;
    double F[18];
    long k;
    int i;

    sh_least_squares_start(&rls, 18, NULL, 1.0);
    for (k = 0; k < count; ++k) {
        for (i = 0; i < 18; ++i) {
            F[i] = (double)((k * (i + 3)) % 101) / 101.0 - 0.5;
        }
        sh_least_squares_update(&rls, SH_RLS_STANDARD, 1.0, F, F[k % 18], &innovation);
    }
}

static void ticks(int method, long count)
{
    static sh_estimator estimator;
    sh_parameters p;
    sh_estimate estimate;
    long k;

    sh_parameters_default(&p);
    p.method = method;
    sh_estimator_start(&estimator, &p, &estimate);
    for (k = 0; k < count; ++k) { /* the values that `steps` sets */
        const sh_measurement z = {
            1e-3 * (double)((7 * k) % 100), 1e-3 * (double)((7 * k + 3) % 100),
            1e-3 * (double)((7 * k + 6) % 100), 1e-3 * (double)((7 * k + 9) % 100), 0.0};

        (void)sh_estimator_tick(&estimator, &p, &z, &estimate);
    }
}
#endif

int main(int argc, char **argv)
{
    const long count = argc == 3 ? atol(argv[2]) : 0;

    check(count > 0, "expected SUBJECT N");
    if (strcmp(argv[1], "step") == 0) {
        steps(count);
#ifndef SH_PLANT
    } else if (strcmp(argv[1], "least_squares") == 0) {
        least_squares(count);
    } else {
        ticks(atoi(argv[1]), count);
#endif
    }
    return 0;
}
