/* The recursion of this project, and the update of the covariance alone. */
#include <stdlib.h>

#include "least_squares.h"
#include "subjects.h"

void *sigmahat_start(int size)
{
    sh_least_squares *rls = size <= SH_MAX_PARAMETERS ? malloc(sizeof *rls) : NULL;

    if (rls != NULL) {
        sh_least_squares_start(rls, size, NULL, BENCH_P_0);
    }
    return rls;
}

void sigmahat_run(void *rls, const double *F, const double *y, int samples)
{
    const int size = ((const sh_least_squares *)rls)->P.size;
    sh_innovation innovation;
    int k;

    for (k = 0; k < samples; ++k) {
        sh_least_squares_update(rls, SH_RLS_STANDARD, 1.0, F + k * size, y[k], &innovation);
    }
}

void sigmahat_eta(const void *rls, double *eta)
{
    const sh_least_squares *own = rls;
    int i;

    for (i = 0; i < own->P.size; ++i) {
        eta[i] = own->eta[i];
    }
}

/* K = P F / (1 + F' P F), P -= K F' P, with all entries of P, for a size known to the compiler. */
#define COVARIANCE(n)                                                                              \
    static void update_##n(double P[n][n], const double *F)                                        \
    {                                                                                              \
        double PF[n], K[n], S = 1.0;                                                               \
        int i, j;                                                                                  \
                                                                                                   \
        for (i = 0; i < n; ++i) {                                                                  \
            PF[i] = 0.0;                                                                           \
            for (j = 0; j < n; ++j)                                                                \
                PF[i] += P[i][j] * F[j];                                                           \
            S += F[i] * PF[i];                                                                     \
        }                                                                                          \
        for (i = 0; i < n; ++i)                                                                    \
            K[i] = PF[i] / S;                                                                      \
        for (i = 0; i < n; ++i)                                                                    \
            for (j = 0; j < n; ++j)                                                                \
                P[i][j] -= K[i] * PF[j];                                                           \
    }                                                                                              \
    static void run_##n(double *P, const double *F, int samples)                                   \
    {                                                                                              \
        int k;                                                                                     \
                                                                                                   \
        for (k = 0; k < samples; ++k)                                                              \
            update_##n((double (*)[n])P, F + k * n);                                               \
    }

COVARIANCE(3)
COVARIANCE(6)
COVARIANCE(18)
COVARIANCE(40)

typedef struct {
    int size;
    void (*run)(double *P, const double *F, int samples);
    double P[]; /* size x size */
} covariance;

void *covariance_start(int size)
{
    covariance *c = calloc(1, sizeof *c + (size_t)(size * size) * sizeof(double));
    int i;

    if (c == NULL) {
        return NULL;
    }
    c->size = size;
    c->run = size == 3 ? run_3 : size == 6 ? run_6 : size == 18 ? run_18 : run_40;
    for (i = 0; i < size; ++i) {
        c->P[i * size + i] = BENCH_P_0;
    }
    return size == 3 || size == 6 || size == 18 || size == 40 ? c : NULL;
}

void covariance_run(void *rls, const double *F, const double *y, int samples)
{
    covariance *c = rls;

    (void)y;
    c->run(c->P, F, samples);
}
