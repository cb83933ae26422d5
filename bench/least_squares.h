/* Recursive least squares of several makes behind the same three functions.
 *
 * All minimise |eta|^2 / BENCH_P_0 + sum (y(k) - F(k)' eta)^2, as far as they can be told to.
 * The samples are those of a delay line, F(k) = (x(k), x(k-1), ...): the only kind that the
 * adaptive filters among them take.
 */
#ifndef BENCH_LEAST_SQUARES_H
#define BENCH_LEAST_SQUARES_H

#ifdef _WIN32
#define BENCH_EXPORT __declspec(dllexport)
#else
#define BENCH_EXPORT __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define BENCH_P_0 1e3

/* Declares for a make:
 *
 * make_start(size)  a new recursion, NULL if it cannot be of this size; it stays until the end
 *                   of the process
 * make_run          takes samples F [size: samples x size], y [size: samples] in order
 * make_eta          its estimate [size: size]
 */
#define BENCH_LEAST_SQUARES(make)                                                                  \
    BENCH_EXPORT void *make##_start(int size);                                                     \
    BENCH_EXPORT void make##_run(void *rls, const double *F, const double *y, int samples);        \
    BENCH_EXPORT void make##_eta(const void *rls, double *eta);

BENCH_LEAST_SQUARES(sigmahat)
BENCH_LEAST_SQUARES(dlib)
BENCH_LEAST_SQUARES(eigen)
BENCH_LEAST_SQUARES(liquid)

/* Not a recursion but a yardstick: the covariance of one as a textbook has it, in plain loops. It
 * has no estimate.
 */
BENCH_EXPORT void *covariance_start(int size);
BENCH_EXPORT void covariance_run(void *rls, const double *F, const double *y, int samples);

/* Multiplications and additions, as many as the machine can do: 2 `times` of BENCH_PEAK numbers. */
enum { BENCH_PEAK = 24 };
BENCH_EXPORT double peak_run(int times);

#ifdef __cplusplus
}
#endif
#endif
