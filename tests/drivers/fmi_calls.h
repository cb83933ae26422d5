/* What FMI 2.0 and FMI 3.0 both have, under one name; -DSH_FMI=2 or -DSH_FMI=3 chooses the version.
 *
 * Instances and states are pointers in both versions. A status has the same numbers.
 */
#ifndef SH_TEST_FMI_CALLS_H
#define SH_TEST_FMI_CALLS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "model.h"

/* If the condition is false, prints `what` and aborts the program. */
static inline void check(int condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "failed: %s\n", what);
        abort();
    }
}

#define fmi_terminate(instance) ((sh_status)FMI(Terminate)(instance))
#define fmi_reset(instance) ((sh_status)FMI(Reset)(instance))
#define fmi_free_instance(instance) FMI(FreeInstance)(instance)
#define fmi_exit_initialization(instance) ((sh_status)FMI(ExitInitializationMode)(instance))
#define fmi_set_debug_logging(instance, on, n, categories)                                         \
    ((sh_status)FMI(SetDebugLogging)(instance, (on) != 0, n, categories))
#define fmi_get_state(instance, state) ((sh_status)FMI_STATE(Get, )(instance, state))
#define fmi_set_state(instance, state) ((sh_status)FMI_STATE(Set, )(instance, state))
#define fmi_free_state(instance, state) ((sh_status)FMI_STATE(Free, )(instance, state))
#define fmi_state_size(instance, state, size)                                                      \
    ((sh_status)FMI_STATE(Serialized, Size)(instance, state, size))
#define fmi_serialize_state(instance, state, bytes, size)                                          \
    ((sh_status)FMI_STATE(Serialize, )(instance, state, (void *)(bytes), size))

#if SH_FMI == 2

#include "fmi2Functions.h"

#define FMI(name) fmi2##name
#define FMI_STATE(before, after) fmi2##before##FMUstate##after
#define fmi_deserialize_state(instance, bytes, size, state)                                        \
    ((sh_status)fmi2DeSerializeFMUstate(instance, (const fmi2Byte *)(bytes), size, state))
#define fmi_get_reals(instance, references, n, values)                                             \
    ((sh_status)fmi2GetReal(instance, references, n, values))
#define fmi_set_reals(instance, references, n, values)                                             \
    ((sh_status)fmi2SetReal(instance, references, n, values))
#define fmi_do_step(instance, t, h) ((sh_status)fmi2DoStep(instance, t, h, fmi2True))

static inline void fmi_ignore(fmi2ComponentEnvironment environment, fmi2String name,
                              fmi2Status status, fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
}

/* A new instance with all messages switched on; they are ignored. */
static inline void *fmi_instantiate(const char *token)
{
    static const fmi2CallbackFunctions callbacks = {fmi_ignore, calloc, free, NULL, NULL};

    return fmi2Instantiate("test", fmi2CoSimulation, token, NULL, &callbacks, fmi2False, fmi2True);
}

/* In FMI 2.0 two calls: if the first one fails, the second one is left out. */
static inline sh_status fmi_enter_initialization(void *instance, double start, int has_stop,
                                                 double stop)
{
    const fmi2Status status = fmi2SetupExperiment(instance, 0, 0.0, start, has_stop, stop);

    return (sh_status)(status == fmi2OK ? fmi2EnterInitializationMode(instance) : status);
}

/* Time of the instance [s], or `otherwise` if the instance does not give its time now. */
static inline double fmi_time(void *instance, double otherwise)
{
    fmi2GetRealStatus(instance, fmi2LastSuccessfulTime, &otherwise);
    return otherwise;
}

/* Sets the time derivative of an input for the next step. FMI 3.0 has none. */
static inline sh_status fmi_set_slope(void *instance, uint32_t input, double slope)
{
    const fmi2Integer order = 1;

    return (sh_status)fmi2SetRealInputDerivatives(instance, &input, 1, &order, &slope);
}

#else

#include "fmi3Functions.h"

#define FMI(name) fmi3##name
#define FMI_STATE(before, after) fmi3##before##FMUState##after
#define fmi_deserialize_state(instance, bytes, size, state)                                        \
    ((sh_status)fmi3DeserializeFMUState(instance, bytes, size, state))
#define fmi_get_reals(instance, references, n, values)                                             \
    ((sh_status)fmi3GetFloat64(instance, references, n, values, n))
#define fmi_set_reals(instance, references, n, values)                                             \
    ((sh_status)fmi3SetFloat64(instance, references, n, values, n))
#define fmi_enter_initialization(instance, start, has_stop, stop)                                  \
    ((sh_status)fmi3EnterInitializationMode(instance, 0, 0.0, start, (has_stop) != 0, stop))
#define fmi_set_slope(instance, input, slope) ((void)(slope), SH_OK)

static inline void fmi_ignore(fmi3InstanceEnvironment environment, fmi3Status status,
                              fmi3String category, fmi3String message)
{
    (void)environment, (void)status, (void)category, (void)message;
}

static inline void *fmi_instantiate(const char *token)
{
    return fmi3InstantiateCoSimulation("test", token, NULL, fmi3False, fmi3True, fmi3False,
                                       fmi3False, NULL, 0, NULL, fmi_ignore, NULL);
}

static inline double fmi_time(void *instance, double otherwise)
{
    const fmi3ValueReference time = (fmi3ValueReference)sh_fmu_model.count;

    fmi3GetFloat64(instance, &time, 1, &otherwise, 1);
    return otherwise;
}

static inline sh_status fmi_do_step(void *instance, double t, double h)
{
    fmi3Boolean event = fmi3True, terminate = fmi3True, early = fmi3True;
    double reached = -1.0;
    const fmi3Status status =
        fmi3DoStep(instance, t, h, fmi3True, &event, &terminate, &early, &reached);

    if (status <= fmi3Warning) {
        check(!event && !terminate && !early && reached == t + h,
              "after a step fmi3DoStep tells what happened");
    }
    return (sh_status)status;
}

#endif

/* Makes an instance ready for the first step, at t = 0. */
static inline void fmi_initialize(void *instance)
{
    check(fmi_enter_initialization(instance, 0.0, 0, 0.0) == SH_OK, "enter initialisation");
    check(fmi_exit_initialization(instance) == SH_OK, "exit initialisation");
}

#endif
