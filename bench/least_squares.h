/* Recursive least squares of several libraries behind the same three functions.
 *
 * All minimise |eta|^2 / BENCH_P_0 + sum (y(k) - F(k)' eta)^2, as far as their parameters allow it.
 * The samples are those of a delay line, F(k) = (x(k), x(k-1), ...), because the adaptive filters
 * among them accept no others.
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
BENCH_LEAST_SQUARES(dlib)
BENCH_LEAST_SQUARES(eigen)
BENCH_LEAST_SQUARES(liquid)

/* For comparison, not a complete recursion: the update of the covariance alone as in textbooks, in
 * plain loops.
 */
BENCH_EXPORT void *covariance_start(int size);
BENCH_EXPORT void covariance_run(void *rls, const double *F, const double *y, int samples);

/* 2 `times` BENCH_PEAK multiplications and additions, as fast as the machine can do them. */
enum { BENCH_PEAK = 24 };
BENCH_EXPORT double peak_run(int times);

#ifdef __cplusplus
}
#endif
#endif
