/* Guards: whether a call of the importer is allowed. A call that is not allowed is refused with an error message. */
#ifndef SH_GUARDS_H
#define SH_GUARDS_H

#include "instance.h"

/* Returns NULL, after a message that the function is not allowed in the state of the instance. */
sh_instance *sh_refuse_call(sh_instance *instance, const char *function);

/* Returns the instance of the importer's handle if the state of the instance is allowed, else NULL after a message.
 * If the handle is NULL, there is no logger for a message.
 */
static inline sh_instance *sh_enter(void *handle, unsigned allowed_states, const char *function)
{
    sh_instance *instance = handle;

    return instance == NULL || ((unsigned)instance->state & allowed_states)
               ? instance
               : sh_refuse_call(instance, function);
}

/* Returns 0, after a message that an argument is NULL. */
int sh_refuse_null(sh_instance *instance, const char *function, const char *argument);

/* Returns 1 if a pointer is not NULL, else 0 after a message. */
static inline int sh_has(sh_instance *instance, const void *pointer, const char *function,
                         const char *argument)
{
    return pointer != NULL || sh_refuse_null(instance, function, argument);
}

/* Returns 1 if the variable may have this value, else 0 after a message. Only parameters have limits. An input may be
 * infinite or NaN, which makes the estimator skip ticks.
 */
int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function);

/* Returns SH_ERROR, after a message that this FMU does not have a feature. The handle may be NULL. */
sh_status sh_refuse_feature(void *handle, const char *function, const char *missing);

#endif
