/* FMI 2.0 for Co-Simulation: the communication step and its status. */
#include "fmi2Functions.h"
#include "simulation.h"

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    return (fmi2Status)sh_communication_step(c, currentCommunicationPoint, communicationStepSize,
                                             "fmi2DoStep");
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2CancelStep");

    if (instance != NULL) {
        sh_report(instance, SH_ERROR,
                  "fmi2CancelStep: no step is in progress; steps run synchronously.");
    }
    return fmi2Error;
}

/* Status information exists for asynchronous and for discarded steps. This FMU has no such steps,
 * and knows only the time of the last step.
 */
static fmi2Status no_status(fmi2Component c, const char *function)
{
    sh_instance *instance = sh_enter(c, SH_STEP | SH_TERMINATED, function);

    if (instance == NULL) {
        return fmi2Error;
    }
    sh_report(instance, SH_DISCARD, "%s: no information of this kind; no step is pending.",
              function);
    return fmi2Discard;
}

#define NO_STATUS(Kind, type)                                                                      \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2StatusKind s, type *value)                 \
    {                                                                                              \
        (void)s;                                                                                   \
        (void)value;                                                                               \
        return no_status(c, "fmi2Get" #Kind);                                                      \
    }

NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(StringStatus, fmi2String)

/* The one status of a type that this FMU knows. It never asks to stop. */
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
