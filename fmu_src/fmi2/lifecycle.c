/* Functions of FMI 2.0 for logging, creation, simulation, and the state of the FMU. */
#include <math.h>

#include "creation.h"
#include "fmi2Functions.h"
#include "guards.h"
#include "log.h"
#include "saved_state.h"
#include "simulation.h"

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    static const char function[] = "fmi2SetDebugLogging";
    sh_instance *instance = sh_enter(c, SH_ANY, function);
    unsigned found = 0;
    sh_status status;

    if (instance == NULL ||
        (nCategories > 0 && !sh_has(instance, categories, function, "categories"))) {
        return fmi2Error;
    }
    status = sh_find_categories(instance, nCategories, categories, &found, function);
    if (!loggingOn) {
        instance->categories = SH_LOG_STATUS; /* all but debug messages */
    } else if (found != 0) {
        instance->categories = found;
    }
    return (fmi2Status)status;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    sh_importer importer;

    (void)fmuResourceLocation; /* the FMU has no resources */
    (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    importer.environment = functions->componentEnvironment;
    importer.logger = (void (*)(void))functions->logger;
    importer.allocate = functions->allocateMemory;
    importer.release = functions->freeMemory;
    if (fmuType != fmi2CoSimulation) {
        return sh_refuse_instance(&importer, "fmi2Instantiate", "model exchange");
    }
    return sh_create(&importer, instanceName, fmuGUID, loggingOn ? SH_LOG_ALL : SH_LOG_STATUS,
                     "fmi2Instantiate");
}

void fmi2FreeInstance(fmi2Component c)
{
    sh_destroy(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    return (fmi2Status)sh_set_up(c, toleranceDefined ? tolerance : 0.0, startTime,
                                 stopTimeDefined ? stopTime : INFINITY, "fmi2SetupExperiment");
}

/* Defines a function of FMI that passes its arguments unchanged to a function of the shell. */
#define FORWARD(Name, parameters, call)                                                            \
    fmi2Status fmi2##Name parameters                                                               \
    {                                                                                              \
        static const char function[] = "fmi2" #Name;                                               \
        return (fmi2Status)(call);                                                                 \
    }

FORWARD(EnterInitializationMode, (fmi2Component c), sh_begin_initialization(c, function))
FORWARD(ExitInitializationMode, (fmi2Component c), sh_end_initialization(c, function))
FORWARD(Terminate, (fmi2Component c), sh_terminate(c, function))
FORWARD(Reset, (fmi2Component c), sh_reset(c, function))

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    return (fmi2Status)sh_communication_step(c, currentCommunicationPoint, communicationStepSize,
                                             "fmi2DoStep");
}

/* FMI 2.0 defines status information for asynchronous and for discarded steps. An FMU of this project has no such
 * steps and only provides the time of its last step.
 */
static fmi2Status no_status(fmi2Component c, const char *function)
{
    sh_instance *instance = sh_enter(c, SH_STEP | SH_TERMINATED, function);

    if (instance == NULL) {
        return fmi2Error;
    }
    sh_report(instance, SH_DISCARD, "%s: there is no such information, because no step is pending.",
              function);
    return fmi2Discard;
}

#define NO_STATUS(Kind, Type)                                                                      \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2StatusKind s, fmi2##Type *value)           \
    {                                                                                              \
        (void)s;                                                                                   \
        (void)value;                                                                               \
        return no_status(c, "fmi2Get" #Kind);                                                      \
    }

NO_STATUS(Status, Status)
NO_STATUS(IntegerStatus, Integer)
NO_STATUS(StringStatus, String)

/* Defines a function that returns the only status of its type that the FMU knows. The FMU never asks to terminate. */
#define STATUS(Type, known, now)                                                                   \
    fmi2Status fmi2Get##Type##Status(fmi2Component c, const fmi2StatusKind s, fmi2##Type *value)   \
    {                                                                                              \
        static const char function[] = "fmi2Get" #Type "Status";                                   \
        sh_instance *instance;                                                                     \
                                                                                                   \
        if (s != (known)) {                                                                        \
            return no_status(c, function);                                                         \
        }                                                                                          \
        instance = sh_enter(c, SH_STEP | SH_TERMINATED, function);                                 \
        if (instance == NULL || !sh_has(instance, value, function, "value")) {                     \
            return fmi2Error;                                                                      \
        }                                                                                          \
        *value = (now);                                                                            \
        return fmi2OK;                                                                             \
    }

STATUS(Real, fmi2LastSuccessfulTime, instance->time)
STATUS(Boolean, fmi2Terminated, fmi2False)

FORWARD(GetFMUstate, (fmi2Component c, fmi2FMUstate *FMUstate),
        sh_save_state(c, FMUstate, function))
FORWARD(SetFMUstate, (fmi2Component c, fmi2FMUstate FMUstate),
        sh_restore_state(c, FMUstate, function))
FORWARD(FreeFMUstate, (fmi2Component c, fmi2FMUstate *FMUstate),
        sh_free_state(c, FMUstate, function))
FORWARD(SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate FMUstate, size_t *size),
        sh_state_size(c, FMUstate, size, function))
FORWARD(SerializeFMUstate,
        (fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size),
        sh_serialize_state(c, FMUstate, serializedState, size, function))
FORWARD(DeSerializeFMUstate,
        (fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate),
        sh_deserialize_state(c, serializedState, size, FMUstate, function))
