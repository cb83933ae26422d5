#include "drive.h"
#include "fmi3Functions.h"
#include "fmi_calls.h"

static void ignore(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                   fmi3String message)
{
    (void)environment;
    (void)status;
    (void)category;
    (void)message;
}

void *fmi_instantiate(void)
{
    return fmi3InstantiateCoSimulation("test", sh_fmu_model.guid, NULL, fmi3False, fmi3True,
                                       fmi3False, fmi3False, NULL, 0, NULL, ignore, NULL);
}

void fmi_free_instance(void *instance)
{
    fmi3FreeInstance(instance);
}

sh_status fmi_set_debug_logging(void *instance, int on, size_t n, const char *const categories[])
{
    return (sh_status)fmi3SetDebugLogging(instance, on != 0, n, categories);
}

sh_status fmi_enter_initialization(void *instance, int tolerance_defined, double tolerance,
                                   double start_time, int stop_time_defined, double stop_time)
{
    return (sh_status)fmi3EnterInitializationMode(instance, tolerance_defined != 0, tolerance,
                                                  start_time, stop_time_defined != 0, stop_time);
}

sh_status fmi_exit_initialization(void *instance)
{
    return (sh_status)fmi3ExitInitializationMode(instance);
}

sh_status fmi_do_step(void *instance, double t, double h)
{
    fmi3Boolean event = fmi3True, terminate = fmi3True, early = fmi3True;
    double reached = -1.0;
    const fmi3Status status =
        fmi3DoStep(instance, t, h, fmi3True, &event, &terminate, &early, &reached);

    if (status <= fmi3Warning) {
        check(!event && !terminate && !early && reached == fmi_time(instance, -1.0),
              "after a step fmi3DoStep tells what happened");
    }
    return (sh_status)status;
}

sh_status fmi_terminate(void *instance)
{
    return (sh_status)fmi3Terminate(instance);
}

sh_status fmi_reset(void *instance)
{
    return (sh_status)fmi3Reset(instance);
}

double fmi_time(void *instance, double otherwise)
{
    const fmi3ValueReference time = (fmi3ValueReference)sh_fmu_model.count;

    fmi3GetFloat64(instance, &time, 1, &otherwise, 1);
    return otherwise;
}

sh_status fmi_get_reals(void *instance, const uint32_t references[], size_t n, double values[])
{
    return (sh_status)fmi3GetFloat64(instance, references, n, values, n);
}

sh_status fmi_set_reals(void *instance, const uint32_t references[], size_t n,
                        const double values[])
{
    return (sh_status)fmi3SetFloat64(instance, references, n, values, n);
}

sh_status fmi_set_slope(void *instance, uint32_t input, double slope)
{
    (void)instance;
    (void)input;
    (void)slope;
    return SH_OK;
}

sh_status fmi_get_state(void *instance, void **state)
{
    return (sh_status)fmi3GetFMUState(instance, state);
}

sh_status fmi_set_state(void *instance, void *state)
{
    return (sh_status)fmi3SetFMUState(instance, state);
}

sh_status fmi_free_state(void *instance, void **state)
{
    return (sh_status)fmi3FreeFMUState(instance, state);
}

sh_status fmi_state_size(void *instance, void *state, size_t *size)
{
    return (sh_status)fmi3SerializedFMUStateSize(instance, state, size);
}

sh_status fmi_serialize_state(void *instance, void *state, uint8_t bytes[], size_t size)
{
    return (sh_status)fmi3SerializeFMUState(instance, state, bytes, size);
}

sh_status fmi_deserialize_state(void *instance, const uint8_t bytes[], size_t size, void **state)
{
    return (sh_status)fmi3DeserializeFMUState(instance, bytes, size, state);
}
