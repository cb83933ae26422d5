/* The phases of a simulation: set-up, initialisation, communication steps, termination. The importer passes `handle`,
 * which may be NULL.
 */
#ifndef SH_SIMULATION_H
#define SH_SIMULATION_H

#include "instance.h"

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

/* Checks the parameters and computes the initial outputs, if a value was set after the last computation. */
sh_status sh_initialize(sh_instance *instance);

#endif
