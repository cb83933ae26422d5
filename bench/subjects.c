/* What is measured in C: recursive least squares, and the tick of the estimator.
 *
 * A recursion has three functions, as those of Eigen in subjects.cpp. It minimises
 * |eta|^2 / P_0 + sum (y(k) - F(k)' eta)^2. What <name>_start makes exists until the end of the process;
 * it is NULL if it is refused.
 */
#include <stdlib.h>
#include <string.h>

#include "least_squares.h"
#include "sigmahat.h"

void *sigmahat_start(int size, double P_0)
{
    sh_least_squares *rls = size <= SH_MAX_PARAMETERS ? malloc(sizeof *rls) : NULL;

    if (rls != NULL) {
        sh_least_squares_start(rls, size, NULL, P_0);
    }
    return rls;
}

/* Takes samples F [size: samples x size], y [size: samples] in order. */
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

/* For comparison, not a complete recursion: the update of the covariance alone, as in textbooks. */
void *covariance_start(int size, double P_0)
{
    covariance *c = calloc(1, sizeof *c + (size_t)(size * size) * sizeof(double));
    int i;

    if (c == NULL) {
        return NULL;
    }
    c->size = size;
    c->run = size == 3 ? run_3 : size == 6 ? run_6 : size == 18 ? run_18 : run_40;
    for (i = 0; i < size; ++i) {
        c->P[i * size + i] = P_0;
    }
    return size == 3 || size == 6 || size == 18 || size == 40 ? c : NULL;
}

void covariance_run(void *rls, const double *F, const double *y, int samples)
{
    covariance *c = rls;

    (void)y;
    c->run(c->P, F, samples);
}

typedef struct {
    sh_parameters parameters;
    sh_estimator estimator;
    sh_estimate estimate;
} tick;

static int choose(sh_parameters *p, const char *method)
{
    sh_prior_parameters *prior = &p->prior;

    if (strcmp(method, "Paper2011") == 0) {
        return 1;
    }
    p->method = SH_METHOD_FILTERED_REGRESSION;
    prior->B = 0.03;
    if (strcmp(method, "FilteredRegression") == 0) {
        return 1;
    }
    prior->bias = prior->damping = prior->load_friction = prior->eccentric = 0;
    prior->delay = prior->reversal = 0;
    prior->power = prior->gap = prior->hysteresis = prior->eccentric_motor = 0;
    return strcmp(method, "FilteredRegression, 21 columns") == 0;
}

/* A new estimator of the AwAS with n = 6, m = 3, in the modality Residual; FilteredRegression estimates
 * all three motor data. */
void *tick_start(const char *method)
{
    tick *own = malloc(sizeof *own);
    sh_violation violation;

    if (own == NULL) {
        return NULL;
    }
    sh_parameters_default(&own->parameters);
    if (!choose(&own->parameters, method) ||
        sh_parameters_check(&own->parameters, &violation) != 0) {
        free(own);
        return NULL;
    }
    sh_estimator_start(&own->estimator, &own->parameters, &own->estimate);
    return own;
}

/* Runs ticks on z [size: samples x 5], and writes outputs of the last one [size: 3]. */
void tick_run(void *ticks, const double *z, int samples, double *outputs)
{
    tick *own = ticks;
    int k;

    for (k = 0; k < samples; ++k) {
        const double *row = z + 5 * k;
        const sh_measurement measured = {row[0], row[1], row[2], row[3], row[4]};
        sh_estimator_tick(&own->estimator, &own->parameters, &measured, &own->estimate);
    }
    outputs[0] = own->estimate.sigma;
    outputs[1] = own->estimate.tau_e;
    outputs[2] = own->estimate.theta_dot;
}
