/* The communication step, the same in every version of FMI. */
#include <float.h>
#include <math.h>

#include "access.h"
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
            *sh_slope(instance, variable) = 0.0;
    }
}

sh_status sh_communication_step(void *handle, double t, double h, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_STEP, function);
    double late, rounding, longest;
    sh_status status;

    if (instance == NULL)
        return SH_ERROR;
    if (!(h > 0.0) || !isfinite(h)) {
        sh_log(instance, SH_ERROR,
               "%s: communicationStepSize = %.9g s; expected a finite number above 0.", function,
               h);
        return SH_ERROR;
    }
    /* An importer that adds up its time makes rounding errors. They have no effect, as ticks are
     * counted by h. A larger difference that is still small comes from an importer whose h does not
     * quite fit its times: then this step also covers the difference, so that it ends at t + h.
     */
    late = t - instance->time;
    rounding = 8.0 * DBL_EPSILON * fabs(t);
    if (!isfinite(t) || !(fabs(late) <= fmin(1e-3 * h, 1e-6) + rounding)) {
        sh_log(instance, SH_ERROR,
               "%s: currentCommunicationPoint = %.15g s; expected %.15g s, "
               "where the last step ended.",
               function, t, instance->time);
        return SH_ERROR;
    }
    /* Importers round: some make a last step of 1e-13 s, to a time or from a time that is off by that
     * much. So the tolerance is of their usual step, not of this one.
     */
    longest = fmax(instance->longest_step, h);
    if (t + h > instance->stop_time + 1e-3 * longest) {
        sh_log(instance, SH_ERROR,
               "%s: a step from t = %.9g s to %.9g s; expected an end not after stopTime = %.9g s.",
               function, t, t + h, instance->stop_time);
        return SH_ERROR;
    }
    if (sh_check_parameters(instance) != SH_OK)
        return SH_ERROR;
    status = sh_fmu_model.step(instance->model, t, fabs(late) > rounding ? h + late : h, instance);
    if (status > SH_WARNING)
        return status;
    instance->time = t + h;
    instance->longest_step = longest;
    clear_input_derivatives(instance);
    return status;
}

sh_status sh_terminate(void *handle, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_STEP, function);

    if (instance == NULL)
        return SH_ERROR;
    instance->state = SH_TERMINATED;
    return SH_OK;
}
