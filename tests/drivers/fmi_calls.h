/* What FMI 2.0 and FMI 3.0 both have, under one name: a driver is linked with fmi2_calls.c or with
 * fmi3_calls.c.
 *
 * Instances and states are pointers in both versions. A status has the same numbers.
 */
#ifndef SH_TEST_FMI_CALLS_H
#define SH_TEST_FMI_CALLS_H

#include <stddef.h>
#include <stdint.h>

#include "model.h"

/* A new instance with all messages switched on; they are ignored. */
void *fmi_instantiate(void);
void fmi_free_instance(void *instance);
sh_status fmi_set_debug_logging(void *instance, int on, size_t n, const char *const categories[]);

/* In FMI 2.0 two calls: if the first one fails, the second one is left out. */
sh_status fmi_enter_initialization(void *instance, int tolerance_defined, double tolerance,
                                   double start_time, int stop_time_defined, double stop_time);
sh_status fmi_exit_initialization(void *instance);
sh_status fmi_do_step(void *instance, double t, double h);
sh_status fmi_terminate(void *instance);
sh_status fmi_reset(void *instance);

/* Time of the instance [s], or `otherwise` if it does not tell it now. */
double fmi_time(void *instance, double otherwise);

/* Reads or writes Real variables. values [size: n] */
sh_status fmi_get_reals(void *instance, const uint32_t references[], size_t n, double values[]);
sh_status fmi_set_reals(void *instance, const uint32_t references[], size_t n,
                        const double values[]);

/* Sets the time derivative of an input for the next step. FMI 3.0 has none: there, it does nothing.
 */
sh_status fmi_set_slope(void *instance, uint32_t input, double slope);

sh_status fmi_get_state(void *instance, void **state);
sh_status fmi_set_state(void *instance, void *state);
sh_status fmi_free_state(void *instance, void **state);
sh_status fmi_state_size(void *instance, void *state, size_t *size);
sh_status fmi_serialize_state(void *instance, void *state, uint8_t bytes[], size_t size);
sh_status fmi_deserialize_state(void *instance, const uint8_t bytes[], size_t size, void **state);

#endif
