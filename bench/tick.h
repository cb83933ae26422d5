/* Ticks of the estimator without an FMU around it. */
#ifndef BENCH_TICK_H
#define BENCH_TICK_H

#include "least_squares.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { BENCH_MEASUREMENTS = 5 }; /* theta, q, theta_c, tau, tau_e_sensor */

/* A new estimator of the AwAS with n = 6, m = 3, in the modality Residual: "Paper2011", or
 * "FilteredRegression" with all three motor data estimated. NULL if there is no such method. It exists
 * until the end of the process.
 */
BENCH_EXPORT void *tick_start(const char *method);

/* Runs ticks on measurements z [size: samples x BENCH_MEASUREMENTS], and writes sigma, tau_e and
 * theta_dot of the last tick to outputs [size: 3].
 */
BENCH_EXPORT void tick_run(void *ticks, const double *z, int samples, double *outputs);

/* Size of the structs of one estimator [bytes]: its state, its parameters, its estimate. */
BENCH_EXPORT void tick_bytes(int *bytes);

#ifdef __cplusplus
}
#endif
#endif
