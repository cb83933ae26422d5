/* A master in C for one FMU of FMI 2.0: it loads the binary and makes steps. */
#ifndef BENCH_MASTER_H
#define BENCH_MASTER_H

#include "least_squares.h"

/* An FMU initialised at time 0, NULL if that fails; it exists until the end of the process.
 *
 * binary, guid, resources  path of the shared library, its GUID, URI of its resources
 * inputs, outputs          value references [size: their counts], of Real variables
 * slopes                   1: inputs are linear over a step, 0: held
 */
BENCH_EXPORT void *master_start(const char *binary, const char *guid, const char *resources,
                                const unsigned *inputs, int input_count, const unsigned *outputs,
                                int output_count, int slopes);

/* Makes steps of h [s]. Before each it sets the inputs, one row of u [size: samples x inputs], and
 * after each it reads all outputs into y [size: outputs]. Returns the number of calls that failed.
 */
BENCH_EXPORT int master_run(void *master, const double *u, int samples, double h, double *y);

/* The same for two FMUs, of which `to` is the estimator of the plant `from`: the first outputs of the
 * plant, as many as the estimator has inputs, are its inputs. Outputs are as before the step of the
 * plant.
 */
BENCH_EXPORT int master_run_pair(void *from, void *to, const double *u, int samples, double h,
                                 double *y_from, double *y_to);

#endif
