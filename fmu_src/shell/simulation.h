/* Operations on an instance, the same in every version of FMI.
 *
 * The functions of FMI (fmi2/, fmi3/) only translate arguments and status. Each function here that
 * takes the name of a function of FMI begins its messages with this name.
 */
#ifndef SH_SIMULATION_H
#define SH_SIMULATION_H

#include "instance.h"

/* A new instance that passes on some categories of messages, or NULL after a message. */
sh_instance *sh_create(const sh_importer *importer, const char *name, const char *guid,
                       unsigned categories, const char *function);
/* NULL, after a message that the FMU is not for the wanted kind of simulation. */
void *sh_refuse_instance(const sh_importer *importer, const char *function, const char *wanted);
void sh_destroy(sh_instance *instance);

/* SH_ERROR, after a message that this FMU does not have a feature. `handle` may be NULL. */
sh_status sh_refuse_feature(void *handle, const char *function, const char *missing);

/* NULL, after a message that the function is not allowed in this state. */
sh_instance *sh_refuse_call(sh_instance *instance, const char *function);

/* The instance of the importer's handle if the instance is in an allowed state; else NULL, after a
 * message. Without a handle there is no logger for a message.
 */
static inline sh_instance *sh_enter(void *handle, unsigned allowed_states, const char *function)
{
    sh_instance *instance = handle;

    return instance == NULL || ((unsigned)instance->state & allowed_states)
               ? instance
               : sh_refuse_call(instance, function);
}

/* 0, after a message that an argument is NULL. */
int sh_refuse_null(sh_instance *instance, const char *function, const char *argument);

/* 1 if the pointer is not NULL; else 0, after a message. */
static inline int sh_has(sh_instance *instance, const void *pointer, const char *function,
                         const char *argument)
{
    return pointer != NULL || sh_refuse_null(instance, function, argument);
}

/* Memory, set to 0, from the functions of the importer, or else from the C library. */
void *sh_allocate(const sh_importer *importer, size_t size);
void sh_release(const sh_importer *importer, void *memory);

/* The course of a simulation. `handle` is from the importer, and may be NULL. */

/* Start and end of the experiment that the importer announces [s]; without an end, it is infinite.
 * Refuses times that are not finite or in the wrong order, and a tolerance that is negative or not finite. Otherwise
 * the tolerance has no effect. It is 0 if the importer gives none.
 */
sh_status sh_set_up(void *handle, double tolerance, double start_time, double stop_time,
                    const char *function);

sh_status sh_begin_initialization(void *handle, const char *function);
sh_status sh_end_initialization(void *handle, const char *function);
sh_status sh_communication_step(void *handle, double t, double h, const char *function);
sh_status sh_terminate(void *handle, const char *function);

/* Back to the state after sh_create, with all start values. The categories of messages stay. */
sh_status sh_reset(void *handle, const char *function);

/* Checks constraints between parameters, if a parameter was set since the last check. */
sh_status sh_check_parameters(sh_instance *instance);

/* Checks the parameters and computes the initial outputs, if anything was set since the last time.
 */
sh_status sh_initialize(sh_instance *instance);

/* Saving, restoring and serialising the state of the FMU. A function that fails returns SH_ERROR after a message, and
 * changes nothing. The function sh_save_state writes the state to *state, or to new memory if *state is NULL; the
 * serialised state has *size bytes.
 */
sh_status sh_save_state(void *handle, void **state, const char *function);
sh_status sh_restore_state(void *handle, void *state, const char *function);
sh_status sh_free_state(void *handle, void **state, const char *function);
sh_status sh_state_size(void *handle, const void *state, size_t *size, const char *function);
sh_status sh_serialize_state(void *handle, const void *state, void *bytes, size_t size,
                             const char *function);
sh_status sh_deserialize_state(void *handle, const void *bytes, size_t size, void **state,
                               const char *function);

#endif
