/* Operations on an instance of the FMU, for every version of FMI.
 *
 * The FMI functions in fmi2/ and fmi3/ only translate arguments and status. The argument `function` of the functions
 * below is the name of an FMI function, with which all messages begin.
 */
#ifndef SH_SIMULATION_H
#define SH_SIMULATION_H

#include "instance.h"

/* Creates an instance that logs the given categories of messages. Returns NULL after an error message. */
sh_instance *sh_create(const sh_importer *importer, const char *name, const char *guid,
                       unsigned categories, const char *function);
/* Returns NULL, after a message that the FMU does not support the wanted kind of simulation. */
void *sh_refuse_instance(const sh_importer *importer, const char *function, const char *wanted);
void sh_destroy(sh_instance *instance);

/* Returns SH_ERROR, after a message that this FMU does not have a feature. The handle may be NULL. */
sh_status sh_refuse_feature(void *handle, const char *function, const char *missing);

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

/* Allocates memory filled with zeros, by the functions of the importer if there are any, else by the C library. */
void *sh_allocate(const sh_importer *importer, size_t size);
void sh_release(const sh_importer *importer, void *memory);

/* The phases of a simulation. The importer passes `handle`, which may be NULL. */

/* Sets start and stop time of the simulation [s]; without a stop time, stop_time is infinite. Refuses a start time that
 * is not finite, a stop time before the start time, and a tolerance that is negative or not finite. A valid tolerance
 * has no effect; without a tolerance of the importer, `tolerance` is 0.
 */
sh_status sh_set_up(void *handle, double tolerance, double start_time, double stop_time,
                    const char *function);

sh_status sh_begin_initialization(void *handle, const char *function);
sh_status sh_end_initialization(void *handle, const char *function);
sh_status sh_communication_step(void *handle, double t, double h, const char *function);
sh_status sh_terminate(void *handle, const char *function);

/* Resets an instance to its state after sh_create with all start values. The logged categories remain the same. */
sh_status sh_reset(void *handle, const char *function);

/* Checks the constraints between parameters, if a parameter was set after the last check. */
sh_status sh_check_parameters(sh_instance *instance);

/* Checks the parameters and computes the initial outputs, if a value was set after the last computation. */
sh_status sh_initialize(sh_instance *instance);

/* Functions that save, restore and serialise the state of the FMU. A function that fails returns SH_ERROR after a
 * message and changes nothing. The function sh_save_state writes to *state, or to new memory if *state is NULL. The
 * function sh_state_size writes the number of bytes of a serialised state to *size.
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
