#include "guards.h"

#include <math.h>

static const char *state_name(sh_state state)
{
    switch (state) {
    case SH_INSTANTIATED:
        return "before initialisation";
    case SH_INITIALIZATION:
        return "in initialisation mode";
    case SH_STEP:
        return "between steps";
    default:
        return "after termination";
    }
}

sh_instance *sh_refuse_call(sh_instance *instance, const char *function)
{
    sh_report(instance, SH_ERROR, "%s: not allowed %s.", function, state_name(instance->state));
    return NULL;
}

int sh_refuse_null(sh_instance *instance, const char *function, const char *argument)
{
    sh_report(instance, SH_ERROR, "%s: argument %s is NULL.", function, argument);
    return 0;
}

int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function)
{
    const double min = variable->min, max = variable->max;

    if (!sh_is_parameter(variable) || (isfinite(value) && value >= min && value <= max)) {
        return 1;
    }
    /* The error message shows the allowed range as "[0, 1]" or "(-inf, inf)". */
    sh_report(instance, SH_ERROR, "%s: parameter %s = %.9g is out of its range %c%.9g, %.9g%c.",
              function, variable->name, value, isfinite(min) ? '[' : '(', min, max,
              isfinite(max) ? ']' : ')');
    return 0;
}

sh_status sh_refuse_feature(void *handle, const char *function, const char *missing)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);

    if (instance != NULL) {
        sh_report(instance, SH_ERROR, "%s: %s has no %s.", function, sh_fmu_model.identifier,
                  missing);
    }
    return SH_ERROR;
}
