/* The value of one variable of an instance. */
#ifndef SH_VALUE_H
#define SH_VALUE_H

#include <limits.h>

#include "instance.h"

static inline int sh_is_parameter(const sh_variable *variable)
{
    return variable->role == SH_ROLE_FIXED || variable->role == SH_ROLE_TUNABLE;
}

/* 1 if the variable may have this value; else 0, after a message. Only parameters have limits: an
 * input that is not finite skips ticks.
 */
int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function);

static inline void *sh_place(const sh_instance *instance, const sh_variable *variable)
{
    return (char *)instance->model + variable->offset;
}

/* The value of a variable of any type: a double holds every int. */
static inline double sh_read(const sh_instance *instance, const sh_variable *variable)
{
    const void *place = sh_place(instance, variable);

    return variable->type == SH_TYPE_REAL ? *(const double *)place : (double)*(const int *)place;
}

static inline void sh_write(sh_instance *instance, const sh_variable *variable, double value)
{
    void *place = sh_place(instance, variable);

    if (variable->type == SH_TYPE_REAL) {
        *(double *)place = value;
    } else {
        /* The value is in its range, unless the importer changed it after the check. */
        *(int *)place = value >= INT_MAX ? INT_MAX : value > INT_MIN ? (int)value : INT_MIN;
    }
}

/* Time derivative of a Real input. */
static inline double *sh_slope(sh_instance *instance, const sh_variable *input)
{
    return (double *)(void *)((char *)sh_place(instance, input) + sh_fmu_model.derivative_offset);
}

#endif
