#include <stdlib.h>
#include <string.h>

#include "sigmahat.h"
#include "subjects.h"

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

void tick_run(void *ticks, const double *z, int samples, double *outputs)
{
    tick *own = ticks;
    int k;

    for (k = 0; k < samples; ++k) {
        const double *row = z + k * BENCH_MEASUREMENTS;
        const sh_measurement measured = {row[0], row[1], row[2], row[3], row[4]};
        sh_estimator_tick(&own->estimator, &own->parameters, &measured, &own->estimate);
    }
    outputs[0] = own->estimate.sigma;
    outputs[1] = own->estimate.tau_e;
    outputs[2] = own->estimate.theta_dot;
}
