/* From the instance to its first step: parameters are checked, and initial outputs computed. */
#include <math.h>

#include "simulation.h"
#include "value.h"

sh_status sh_check_parameters(sh_instance *instance)
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

/* Parameters that are each in their range may together still give numbers that are too large. */
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
    /*@ dynamic_split instance->parameters_unchecked; */ /* for the proof of docs/proof/shell.md */
    if (!instance->outputs_stale) {
        return SH_OK;
    }
    if (sh_check_parameters(instance) != SH_OK) {
        return SH_ERROR;
    }
    sh_fmu_model.initialize(instance->model, instance->time);
    if (!outputs_are_finite(instance)) {
        return SH_ERROR;
    }
    instance->outputs_stale = 0;
    return SH_OK;
}

sh_status sh_set_up(sh_instance *instance, const sh_experiment *experiment, const char *function)
{
    const sh_experiment *e = experiment;

    if (e->tolerance_defined && !(e->tolerance >= 0.0 && isfinite(e->tolerance))) {
        sh_report(instance, SH_ERROR,
                  "%s: tolerance = %.9g; expected a finite number, not below 0.", function,
                  e->tolerance);
        return SH_ERROR;
    }
    if (!isfinite(e->start_time)) {
        sh_report(instance, SH_ERROR, "%s: startTime = %g is not finite.", function, e->start_time);
        return SH_ERROR;
    }
    if (e->stop_time_defined && !(e->stop_time >= e->start_time)) {
        sh_report(instance, SH_ERROR, "%s: stopTime = %.9g is before startTime = %.9g.", function,
                  e->stop_time, e->start_time);
        return SH_ERROR;
    }
    instance->time = e->start_time;
    instance->stop_time = e->stop_time_defined ? e->stop_time : INFINITY;
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

/* After an error of a parameter the instance stays in initialisation mode, so that the importer can
 * correct the parameter.
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
