#include "value.h"

#include <math.h>
#include <stdio.h>

/* Writes the allowed range of a variable, "[0, 1]" or "(-inf, inf)". */
static void write_range(char *text, size_t size, const sh_variable *variable)
{
    (void)snprintf(text, size, "%c%.9g, %.9g%c", isfinite(variable->min) ? '[' : '(', variable->min,
                   variable->max, isfinite(variable->max) ? ']' : ')');
}

int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function)
{
    char range[64];

    if (!sh_is_parameter(variable) ||
        (isfinite(value) && value >= variable->min && value <= variable->max)) {
        return 1;
    }
    write_range(range, sizeof range, variable);
    sh_report(instance, SH_ERROR, "%s: parameter %s = %.9g is out of its range %s.", function,
              variable->name, value, range);
    return 0;
}
