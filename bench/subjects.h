/* What is measured in C and C++: recursive least squares of several libraries behind the same three
 * functions, and the tick of the estimator.
 *
 * All recursions minimise |eta|^2 / BENCH_P_0 + sum (y(k) - F(k)' eta)^2.
 */
#ifndef BENCH_SUBJECTS_H
#define BENCH_SUBJECTS_H

#define BENCH_EXPORT __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

#define BENCH_P_0 1e3

/* Declares for a library:
 *
 * make_start(size)  a new recursion, NULL if this size is not possible; it exists until the end of
 *                   the process
 * make_run          takes samples F [size: samples x size], y [size: samples] in order
 * make_eta          its estimate [size: size]
 */
#define BENCH_LEAST_SQUARES(make)                                                                  \
    BENCH_EXPORT void *make##_start(int size);                                                     \
    BENCH_EXPORT void make##_run(void *rls, const double *F, const double *y, int samples);        \
    BENCH_EXPORT void make##_eta(const void *rls, double *eta);

BENCH_LEAST_SQUARES(sigmahat)
BENCH_LEAST_SQUARES(eigen)

/* For comparison, not a complete recursion: the update of the covariance alone as in textbooks, in
 * plain loops.
 */
BENCH_EXPORT void *covariance_start(int size);
BENCH_EXPORT void covariance_run(void *rls, const double *F, const double *y, int samples);

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

#ifdef __cplusplus
}
#endif
#endif
