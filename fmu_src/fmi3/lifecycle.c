/* Functions of FMI 3.0 for logging, creation, simulation, and the state of the FMU. */
#include <math.h>

#include "creation.h"
#include "fmi3Functions.h"
#include "guards.h"
#include "log.h"
#include "saved_state.h"
#include "simulation.h"

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    static const char function[] = "fmi3SetDebugLogging";
    sh_instance *entered = sh_enter(instance, SH_ANY, function);
    unsigned found = 0;
    sh_status status;

    if (entered == NULL ||
        (nCategories > 0 && !sh_has(entered, categories, function, "categories"))) {
        return fmi3Error;
    }
    status = sh_find_categories(entered, nCategories, categories, &found, function);
    if (loggingOn) {
        entered->categories |= found;
    } else {
        entered->categories &= ~found;
    }
    return (fmi3Status)status;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    /* An importer of FMI 3.0 passes no functions for memory. */
    const sh_importer importer = {instanceEnvironment, (void (*)(void))logMessage, NULL, NULL};

    (void)resourcePath; /* the FMU has no resources */
    (void)visible;
    (void)earlyReturnAllowed; /* no step ends early */
    (void)requiredIntermediateVariables;
    (void)intermediateUpdate; /* never called */
    if (eventModeUsed) {
        return sh_refuse_instance(&importer, "fmi3InstantiateCoSimulation",
                                  "event mode (hasEventMode is false)");
    }
    if (nRequiredIntermediateVariables > 0) {
        return sh_refuse_instance(&importer, "fmi3InstantiateCoSimulation",
                                  "intermediate update (providesIntermediateUpdate is false)");
    }
    return sh_create(&importer, instanceName, instantiationToken,
                     loggingOn ? SH_LOG_ALL : SH_LOG_ERROR, "fmi3InstantiateCoSimulation");
}

void fmi3FreeInstance(fmi3Instance instance)
{
    sh_destroy(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    static const char function[] = "fmi3EnterInitializationMode";

    if (sh_set_up(instance, toleranceDefined ? tolerance : 0.0, startTime,
                  stopTimeDefined ? stopTime : INFINITY, function) != SH_OK) {
        return fmi3Error;
    }
    return (fmi3Status)sh_begin_initialization(instance, function);
}

/* Defines a function of FMI that passes its arguments unchanged to a function of the shell. */
#define FORWARD(Name, parameters, call)                                                            \
    fmi3Status fmi3##Name parameters                                                               \
    {                                                                                              \
        static const char function[] = "fmi3" #Name;                                               \
        return (fmi3Status)(call);                                                                 \
    }

FORWARD(ExitInitializationMode, (fmi3Instance instance), sh_end_initialization(instance, function))

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    sh_instance *entered = sh_enter(instance, SH_STEP, "fmi3DoStep");
    sh_status status;

    (void)noSetFMUStatePriorToCurrentPoint;
    if (entered == NULL ||
        !sh_has(entered, eventHandlingNeeded, "fmi3DoStep", "eventHandlingNeeded") ||
        !sh_has(entered, terminateSimulation, "fmi3DoStep", "terminateSimulation") ||
        !sh_has(entered, earlyReturn, "fmi3DoStep", "earlyReturn") ||
        !sh_has(entered, lastSuccessfulTime, "fmi3DoStep", "lastSuccessfulTime")) {
        return fmi3Error;
    }
    status = sh_communication_step(entered, currentCommunicationPoint, communicationStepSize,
                                   "fmi3DoStep");
    *eventHandlingNeeded = fmi3False;
    *terminateSimulation = fmi3False;
    *earlyReturn = fmi3False;
    *lastSuccessfulTime = entered->time;
    return (fmi3Status)status;
}

FORWARD(Terminate, (fmi3Instance instance), sh_terminate(instance, function))
FORWARD(Reset, (fmi3Instance instance), sh_reset(instance, function))
FORWARD(GetFMUState, (fmi3Instance instance, fmi3FMUState *FMUState),
        sh_save_state(instance, FMUState, function))
FORWARD(SetFMUState, (fmi3Instance instance, fmi3FMUState FMUState),
        sh_restore_state(instance, FMUState, function))
FORWARD(FreeFMUState, (fmi3Instance instance, fmi3FMUState *FMUState),
        sh_free_state(instance, FMUState, function))
FORWARD(SerializedFMUStateSize, (fmi3Instance instance, fmi3FMUState FMUState, size_t *size),
        sh_state_size(instance, FMUState, size, function))
FORWARD(SerializeFMUState,
        (fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size),
        sh_serialize_state(instance, FMUState, serializedState, size, function))
FORWARD(DeserializeFMUState,
        (fmi3Instance instance, const fmi3Byte serializedState[], size_t size,
         fmi3FMUState *FMUState),
        sh_deserialize_state(instance, serializedState, size, FMUState, function))
