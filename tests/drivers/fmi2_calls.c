#include <stdlib.h>

#include "fmi2Functions.h"
#include "fmi_calls.h"

static void ignore(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    (void)message;
}

void *fmi_instantiate(void)
{
    static const fmi2CallbackFunctions callbacks = {ignore, calloc, free, NULL, NULL};

    return fmi2Instantiate("test", fmi2CoSimulation, sh_fmu_model.guid, NULL, &callbacks, fmi2False,
                           fmi2True);
}

void fmi_free_instance(void *instance)
{
    fmi2FreeInstance(instance);
}

sh_status fmi_set_debug_logging(void *instance, int on, size_t n, const char *const categories[])
{
    return (sh_status)fmi2SetDebugLogging(instance, on, n, categories);
}

sh_status fmi_enter_initialization(void *instance, int tolerance_defined, double tolerance,
                                   double start_time, int stop_time_defined, double stop_time)
{
    const fmi2Status status = fmi2SetupExperiment(instance, tolerance_defined, tolerance,
                                                  start_time, stop_time_defined, stop_time);

    return (sh_status)(status == fmi2OK ? fmi2EnterInitializationMode(instance) : status);
}

sh_status fmi_exit_initialization(void *instance)
{
    return (sh_status)fmi2ExitInitializationMode(instance);
}

sh_status fmi_do_step(void *instance, double t, double h)
{
    return (sh_status)fmi2DoStep(instance, t, h, fmi2True);
}

sh_status fmi_terminate(void *instance)
{
    return (sh_status)fmi2Terminate(instance);
}

sh_status fmi_reset(void *instance)
{
    return (sh_status)fmi2Reset(instance);
}

double fmi_time(void *instance, double otherwise)
{
    fmi2GetRealStatus(instance, fmi2LastSuccessfulTime, &otherwise);
    return otherwise;
}

sh_status fmi_get_reals(void *instance, const uint32_t references[], size_t n, double values[])
{
    return (sh_status)fmi2GetReal(instance, references, n, values);
}

sh_status fmi_set_reals(void *instance, const uint32_t references[], size_t n,
                        const double values[])
{
    return (sh_status)fmi2SetReal(instance, references, n, values);
}

sh_status fmi_set_slope(void *instance, uint32_t input, double slope)
{
    const fmi2Integer order = 1;

    return (sh_status)fmi2SetRealInputDerivatives(instance, &input, 1, &order, &slope);
}

sh_status fmi_get_state(void *instance, void **state)
{
    return (sh_status)fmi2GetFMUstate(instance, state);
}

sh_status fmi_set_state(void *instance, void *state)
{
    return (sh_status)fmi2SetFMUstate(instance, state);
}

sh_status fmi_free_state(void *instance, void **state)
{
    return (sh_status)fmi2FreeFMUstate(instance, state);
}

sh_status fmi_state_size(void *instance, void *state, size_t *size)
{
    return (sh_status)fmi2SerializedFMUstateSize(instance, state, size);
}

sh_status fmi_serialize_state(void *instance, void *state, uint8_t bytes[], size_t size)
{
    return (sh_status)fmi2SerializeFMUstate(instance, state, (fmi2Byte *)bytes, size);
}

sh_status fmi_deserialize_state(void *instance, const uint8_t bytes[], size_t size, void **state)
{
    return (sh_status)fmi2DeSerializeFMUstate(instance, (const fmi2Byte *)bytes, size, state);
}
