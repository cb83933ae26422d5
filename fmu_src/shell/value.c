#include "value.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

/* Writes the allowed range of a variable, "[0, 1]" or "(-inf, inf)". */
static void write_range(char *text, size_t size, const sh_variable *variable)
{
    (void)snprintf(text, size, "%c%.9g, %.9g%c", isfinite(variable->min) ? '[' : '(', variable->min,
                   variable->max, isfinite(variable->max) ? ']' : ')');
}

static int in_range(const sh_variable *variable, double value)
{
    return isfinite(value) && value >= variable->min && value <= variable->max;
}

int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function)
{
    char range[64];

    if (!sh_is_parameter(variable) || in_range(variable, value)) {
        return 1;
    }
    write_range(range, sizeof range, variable);
    sh_log(instance, SH_ERROR, "%s: parameter %s = %.9g is out of its range %s.", function,
           variable->name, value, range);
    return 0;
}

static void *place_of_variable(const sh_instance *instance, const sh_variable *variable)
{
    return (char *)instance->model + variable->offset;
}

double sh_read(const sh_instance *instance, const sh_variable *variable)
{
    const void *place = place_of_variable(instance, variable);

    return variable->type == SH_TYPE_REAL ? *(const double *)place : (double)*(const int *)place;
}

void sh_write(sh_instance *instance, const sh_variable *variable, double value)
{
    void *place = place_of_variable(instance, variable);

    if (variable->type == SH_TYPE_REAL) {
        *(double *)place = value;
    } else {
        /* In its range, unless the importer has changed it since the check. */
        *(int *)place = value >= INT_MAX ? INT_MAX : value > INT_MIN ? (int)value : INT_MIN;
    }
}

double *sh_slope(sh_instance *instance, const sh_variable *input)
{
    return (double *)(void *)((char *)instance->model + input->offset +
                              sh_fmu_model.derivative_offset);
}
