#include "drive.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "model.h"

void check(int condition, const char *what)
{
    if (condition)
        return;
    fprintf(stderr, "failed: %s\n", what);
    exit(1);
}

static void ignore(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    (void)message;
}

fmi2Component start(void)
{
    static const fmi2CallbackFunctions callbacks = {ignore, calloc, free, NULL, NULL};
    fmi2Component instance = fmi2Instantiate("test", fmi2CoSimulation, sh_fmu_model.guid, NULL,
                                             &callbacks, fmi2False, fmi2True);

    check(instance != NULL, "fmi2Instantiate");
    check(fmi2SetupExperiment(instance, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK,
          "fmi2SetupExperiment");
    check(fmi2EnterInitializationMode(instance) == fmi2OK, "fmi2EnterInitializationMode");
    check(fmi2ExitInitializationMode(instance) == fmi2OK, "fmi2ExitInitializationMode");
    return instance;
}

void step(fmi2Component instance, int variant, long k)
{
    const double t = (double)k * 1e-3;
    const fmi2Integer order = 1;
    fmi2ValueReference i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const double frequency = 5.0 + i + variant;
        const double value = 0.3 * sin(frequency * t), slope = 0.3 * frequency * cos(frequency * t);

        if (sh_fmu_model.variables[i].role != SH_ROLE_INPUT)
            continue;
        check(fmi2SetReal(instance, &i, 1, &value) == fmi2OK, "fmi2SetReal");
        check(fmi2SetRealInputDerivatives(instance, &i, 1, &order, &slope) == fmi2OK,
              "fmi2SetRealInputDerivatives");
    }
    check(fmi2DoStep(instance, t, 1e-3, fmi2True) == fmi2OK, "fmi2DoStep");
}

size_t get_outputs(fmi2Component instance, double *values)
{
    fmi2ValueReference i;
    size_t n = 0;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        if (variable->type != SH_TYPE_REAL ||
            (variable->role != SH_ROLE_OUTPUT && variable->role != SH_ROLE_GUESS))
            continue;
        check(n < 256, "more than 256 outputs");
        check(fmi2GetReal(instance, &i, 1, &values[n++]) == fmi2OK, "fmi2GetReal");
    }
    return n;
}
