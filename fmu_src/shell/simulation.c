#include "simulation.h"

#include <float.h>
#include <math.h>

#include "guards.h"

/* Checks the constraints between parameters, if a parameter was set after the last check. */
static sh_status check_parameters(sh_instance *instance)
{
    if (!instance->parameters_unchecked) {
        return SH_OK;
    }
    if (sh_fmu_model.check != NULL && sh_fmu_model.check(instance->model, instance) != SH_OK) {
        return SH_ERROR;
    }
    instance->parameters_unchecked = 0;
    return SH_OK;
}

/* Checks that all outputs are finite. Even parameters within their ranges can together cause an overflow. */
static int outputs_are_finite(sh_instance *instance)
{
    size_t i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        double value;

        if (variable->type != SH_TYPE_REAL ||
            (variable->role != SH_ROLE_OUTPUT && variable->role != SH_ROLE_GUESS)) {
            continue;
        }
        value = sh_read(instance, variable);
        if (!isfinite(value)) {
            sh_report(
                instance, SH_ERROR,
                "Initialisation: output %s = %g is not finite. Look for extreme parameters and "
                "inputs.",
                variable->name, value);
            return 0;
        }
    }
    return 1;
}

sh_status sh_initialize(sh_instance *instance)
{
    /*@ dynamic_split instance->parameters_unchecked; */ /* prover hint: docs/proof/shell.md */
    if (!instance->outputs_stale) {
        return SH_OK;
    }
    if (check_parameters(instance) != SH_OK) {
        return SH_ERROR;
    }
    sh_fmu_model.initialize(instance->model, instance->time);
    if (!outputs_are_finite(instance)) {
        return SH_ERROR;
    }
    instance->outputs_stale = 0;
    return SH_OK;
}

sh_status sh_set_up(void *handle, double tolerance, double start_time, double stop_time,
                    const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_INSTANTIATED, function);

    if (instance == NULL) {
        return SH_ERROR;
    }
    if (!(tolerance >= 0.0 && isfinite(tolerance))) {
        sh_report(instance, SH_ERROR,
                  "%s: tolerance = %.9g; expected a finite number, not below 0.", function,
                  tolerance);
        return SH_ERROR;
    }
    if (!isfinite(start_time)) {
        sh_report(instance, SH_ERROR, "%s: startTime = %g is not finite.", function, start_time);
        return SH_ERROR;
    }
    if (!(stop_time >= start_time)) {
        sh_report(instance, SH_ERROR, "%s: stopTime = %.9g is before startTime = %.9g.", function,
                  stop_time, start_time);
        return SH_ERROR;
    }
    instance->time = start_time;
    instance->stop_time = stop_time;
    return SH_OK;
}

sh_status sh_begin_initialization(void *handle, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_INSTANTIATED, function);

    if (instance == NULL) {
        return SH_ERROR;
    }
    instance->state = SH_INITIALIZATION;
    instance->outputs_stale = 1;
    return SH_OK;
}

/* If a parameter is wrong, the instance stays in initialisation mode, so that the importer can correct the
 * parameter.
 */
sh_status sh_end_initialization(void *handle, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_INITIALIZATION, function);

    if (instance == NULL || sh_initialize(instance) != SH_OK) {
        return SH_ERROR;
    }
    instance->state = SH_STEP;
    sh_report(instance, SH_OK, "Initialised at t = %.9g s.", instance->time);
    return SH_OK;
}

/* Time derivatives of inputs are valid for one communication step. In the next step inputs are constant, unless the
 * importer sets their derivatives again.
 */
static void clear_input_derivatives(sh_instance *instance)
{
    size_t i;

    for (i = 0; i < instance->slopes_end; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        if (variable->role == SH_ROLE_INPUT) {
            *sh_slope(instance, variable) = 0.0;
        }
    }
    instance->slopes_end = 0;
}

/* Returns 1 if a step ends after the stop time only because of rounding errors. Some importers make a last step of
 * 1e-13 s, so the tolerance also depends on the previous step. Some importers add up step lengths, so the error of
 * their time grows with the number of steps.
 */
static int is_rounding(const sh_instance *instance, double t, double h)
{
    const double longer = h > instance->previous_step ? h : instance->previous_step;

    return t + h <= instance->stop_time + 1e-3 * longer + DBL_EPSILON * fabs(t) * instance->steps;
}

sh_status sh_communication_step(void *handle, double t, double h, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_STEP, function);
    double begin = t, length, late, end;
    sh_status status;

    if (instance == NULL) {
        return SH_ERROR;
    }
    /*@ dynamic_split instance->parameters_unchecked; */ /* prover hint: docs/proof/shell.md */
    if (!(h > 0.0) || !isfinite(h)) {
        sh_report(instance, SH_ERROR,
                  "%s: communicationStepSize = %.9g s; expected a finite number above 0.", function,
                  h);
        return SH_ERROR;
    }
    /* An importer that adds up step lengths makes rounding errors in t. Rounding errors of t have no effect, because
     * ticks depend on the sum of all h. The step length h of an importer may not quite fit its times
     * t. The step is then a little longer or shorter than h, and ends at t + h.
     */
    length = h;
    late = t - instance->time;
    if (late != 0.0) { /* or not a number */
        const double rounding = 8.0 * DBL_EPSILON * fabs(t), whole = h + late;
        if (!isfinite(t) || !(fabs(late) <= (h < 1e-3 ? 1e-3 * h : 1e-6) + rounding)) {
            sh_report(instance, SH_ERROR,
                      "%s: currentCommunicationPoint = %.15g s; expected %.15g s, "
                      "where the last step ended.",
                      function, t, instance->time);
            return SH_ERROR;
        }
        /* `whole` can only be negative if h is shorter than the rounding error of t. */
        if (fabs(late) > rounding && whole > 0.0 && isfinite(whole)) {
            begin = instance->time;
            length = whole;
        }
    }
    end = t + h;
    if (isinf(end)) {
        sh_report(instance, SH_ERROR,
                  "%s: a step from t = %.15g s of %.15g s ends beyond the largest number.",
                  function, t, h);
        return SH_ERROR;
    }
    if (end > instance->stop_time && !is_rounding(instance, t, h)) {
        sh_report(
            instance, SH_ERROR,
            "%s: a step from t = %.15g s to %.15g s; expected an end not after stopTime = %.15g "
            "s.",
            function, t, end, instance->stop_time);
        return SH_ERROR;
    }
    if (check_parameters(instance) != SH_OK) {
        return SH_ERROR;
    }
    status = sh_fmu_model.step(instance->model, begin, length, instance->slopes_end == 0, instance);
    if (status > SH_WARNING) {
        return status;
    }
    instance->time = end;
    instance->previous_step = h;
    instance->steps += 1.0;
    clear_input_derivatives(instance);
    return status;
}

sh_status sh_terminate(void *handle, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_STEP, function);

    if (instance == NULL) {
        return SH_ERROR;
    }
    instance->state = SH_TERMINATED;
    return SH_OK;
}
