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

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    (void)s;
    (void)value;
    return no_status(c, "fmi2GetStatus");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    sh_instance *instance;

    if (s != fmi2LastSuccessfulTime) {
        return no_status(c, "fmi2GetRealStatus");
    }
    instance = sh_enter(c, SH_STEP | SH_TERMINATED, "fmi2GetRealStatus");
    if (instance == NULL || !sh_has(instance, value, "fmi2GetRealStatus", "value")) {
        return fmi2Error;
    }
    *value = instance->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    (void)s;
    (void)value;
    return no_status(c, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    sh_instance *instance;

    if (s != fmi2Terminated) {
        return no_status(c, "fmi2GetBooleanStatus");
    }
    instance = sh_enter(c, SH_STEP | SH_TERMINATED, "fmi2GetBooleanStatus");
    if (instance == NULL || !sh_has(instance, value, "fmi2GetBooleanStatus", "value")) {
        return fmi2Error;
    }
    *value = fmi2False; /* the FMU never asks to stop */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    (void)s;
    (void)value;
    return no_status(c, "fmi2GetStringStatus");
}
