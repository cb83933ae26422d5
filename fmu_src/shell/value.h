/* The value of one variable of an instance. */
#ifndef SH_VALUE_H
#define SH_VALUE_H

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

/* The value of a variable of any type: a double holds every int. */
double sh_read(const sh_instance *instance, const sh_variable *variable);
void sh_write(sh_instance *instance, const sh_variable *variable, double value);

/* Time derivative of a Real input. */
double *sh_slope(sh_instance *instance, const sh_variable *input);

#endif
