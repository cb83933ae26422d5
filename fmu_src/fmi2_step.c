/* FMI 2.0 for Co-Simulation: the communication step and its status. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "instance.h"

/* Derivatives of inputs are valid for one step. In the next step inputs are constant, unless the
 * importer sets derivatives again.
 */
static void clear_input_derivatives(sh_instance *instance)
{
    size_t i;

    if (!instance->slopes_set)
        return;
    instance->slopes_set = 0;
    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        if (variable->role == SH_ROLE_INPUT)
            *(double *)(void *)((char *)instance->model + variable->offset +
                                sh_fmu_model.derivative_offset) = 0.0;
    }
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    sh_instance *instance = sh_enter(c, SH_STEP, "fmi2DoStep");
    const double t = currentCommunicationPoint, h = communicationStepSize;
    double late, rounding;
    fmi2Status status;

    (void)noSetFMUStatePriorToCurrentPoint;
    if (instance == NULL)
        return fmi2Error;
    if (!(h > 0.0) || !isfinite(h)) {
        sh_log(instance, fmi2Error,
               "fmi2DoStep: communicationStepSize = %.9g s; expected a finite number above 0.", h);
        return fmi2Error;
    }
    /* An importer that adds up its time makes rounding errors. They have no effect, as ticks are
     * counted by h. A larger difference that is still small comes from an importer whose h does not
     * quite fit its times: then this step also covers the difference, so that it ends at t + h.
     */
    late = t - instance->time;
    rounding = 8.0 * DBL_EPSILON * fabs(t);
    if (!isfinite(t) || !(fabs(late) <= fmin(1e-3 * h, 1e-6) + rounding)) {
        sh_log(instance, fmi2Error,
               "fmi2DoStep: currentCommunicationPoint = %.15g s; expected %.15g s, "
               "where the last step ended.",
               t, instance->time);
        return fmi2Error;
    }
    if (sh_check_parameters(instance) != fmi2OK)
        return fmi2Error;
    status = sh_fmu_model.step(instance->model, t, fabs(late) > rounding ? h + late : h, instance);
    if (status > fmi2Warning)
        return status;
    instance->time = t + h;
    clear_input_derivatives(instance);
    return status;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2CancelStep");

    if (instance != NULL)
        sh_log(instance, fmi2Error,
               "fmi2CancelStep: no step is in progress; steps run synchronously.");
    return fmi2Error;
}

/* Status information exists for asynchronous and for discarded steps. Here there are none, and only
 * the time reached is known.
 */
static fmi2Status no_status(fmi2Component c, const char *function)
{
    sh_instance *instance = sh_enter(c, SH_STEP | SH_TERMINATED, function);

    if (instance == NULL)
        return fmi2Error;
    sh_log(instance, fmi2Discard, "%s: no information of this kind; no step is pending.", function);
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

    if (s != fmi2LastSuccessfulTime)
        return no_status(c, "fmi2GetRealStatus");
    instance = sh_enter(c, SH_STEP | SH_TERMINATED, "fmi2GetRealStatus");
    if (instance == NULL || !sh_has(instance, value, "fmi2GetRealStatus", "value"))
        return fmi2Error;
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

    if (s != fmi2Terminated)
        return no_status(c, "fmi2GetBooleanStatus");
    instance = sh_enter(c, SH_STEP | SH_TERMINATED, "fmi2GetBooleanStatus");
    if (instance == NULL || !sh_has(instance, value, "fmi2GetBooleanStatus", "value"))
        return fmi2Error;
    *value = fmi2False; /* the FMU never asks to stop */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    (void)s;
    (void)value;
    return no_status(c, "fmi2GetStringStatus");
}
