/* Runs estimators of a library whose loops count their rounds: tests/proof/test_loops.py.
 *
 * Arguments: method, rls.n, rls.m, and 1 with the columns that are used if the data ask for them, 0
 * without. Each line: the most rounds of a loop, in the order of the loops,
 * then the most of each pair of loops.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "rounds.h"
#include "sigmahat.h"

/* sh_pairs: inner loop, outer loop, and 1 where the begins of the inner one count, not its rounds. */
static long now[SH_LOOPS], active[SH_LOOPS], sum[SH_PAIRS];
static long most[SH_LOOPS], most_of_pair[SH_PAIRS];

static void add(int loop, int begins)
{
    int i;

    for (i = 0; i < SH_PAIRS; ++i) {
        if (sh_pairs[i][0] == loop && sh_pairs[i][2] == begins && active[sh_pairs[i][1]] &&
            ++sum[i] > most_of_pair[i]) {
            most_of_pair[i] = sum[i];
        }
    }
}

int sh_begin(int loop)
{
    int i;

    now[loop] = 0;
    active[loop] = 1;
    for (i = 0; i < SH_PAIRS; ++i) {
        if (sh_pairs[i][1] == loop) {
            sum[i] = 0;
        }
    }
    add(loop, 1);
    return 0;
}

int sh_round(int loop, int goes_on)
{
    active[loop] = goes_on;
    if (!goes_on) {
        return 0;
    }
    if (++now[loop] > most[loop]) {
        most[loop] = now[loop];
    }
    add(loop, 0);
    return 1;
}

/* Every column, a curve, and every part of a tick that parameters switch on. */
static void use_everything(sh_parameters *p, int optional)
{
    sh_real *const prior = &p->prior.tau_e;
    const int priors = (int)(sizeof p->prior / sizeof *prior);
    int i;

    for (i = 0; i < priors; ++i) {
        prior[i] = prior[i] > 0 ? prior[i] : 0.1;
    }
    if (!optional) { /* then every column is always used */
        p->prior.power = p->prior.gap = p->prior.hysteresis = p->prior.eccentric_motor = 0;
    }
    p->rls.eta_0[p->rls.n - 1][p->rls.m - 1] = 10;
    p->samplePeriod = 0.0125;
    p->regression.bandwidth = 40;
    p->residual.K_I = 50;
}

static void tick(sh_estimator *estimator, const sh_parameters *p, int k, sh_estimate *estimate)
{
    const double t = k * p->samplePeriod, w = 7, friction = k > 800 ? 2 : 0.02;
    const double theta = 0.5 * sin(w * t) + 0.2 * sin(1.7 * w * t), phi = 0.1 * sin(w * t);
    sh_measurement z = {0};

    z.theta = theta;
    z.q = k % 500 == 499 ? NAN : theta + phi;
    z.theta_c = sin(0.3 * t);
    z.tau = (cos(w * t) > 0 ? friction : -friction) + 0.1 * sin(31 * t) - 3 * phi;
    sh_estimator_tick(estimator, p, &z, estimate);
}

int main(int argc, char **argv)
{
    static sh_estimator estimator;
    sh_parameters p;
    sh_violation violation;
    sh_estimate estimate;
    int k;

    if (argc != 5) {
        return 2;
    }
    sh_parameters_default(&p);
    p.method = atoi(argv[1]);
    p.rls.n = atoi(argv[2]);
    p.rls.m = atoi(argv[3]);
    use_everything(&p, atoi(argv[4]));
    if (sh_parameters_check(&p, &violation)) {
        printf("%s: expected %s\n", violation.name, violation.range);
        return 1;
    }
    sh_estimator_start(&estimator, &p, &estimate);
    for (k = 0; k < 1600; ++k) {
        p.regression.drift = k > 1500 ? 0.1 : 0;
        tick(&estimator, &p, k, &estimate);
    }
    if (p.method == SH_METHOD_PAPER2011) { /* every column is cleared */
        for (k = 0; k < p.rls.n * p.rls.m; ++k) {
            estimator.method.paper2011.rls.P.D[k] = 0;
        }
        tick(&estimator, &p, 1600, &estimate);
    }
    if (sh_estimator_check(&estimator, &p)) {
        printf("the estimator has a state that it refuses\n");
        return 1;
    }
    printf("%d\n",
           p.method == SH_METHOD_FILTERED_REGRESSION ? estimator.method.regression.size : 0);
    for (k = 0; k < SH_LOOPS; ++k) {
        printf("%ld\n", most[k]);
    }
    for (k = 0; k < SH_PAIRS; ++k) {
        printf("%ld\n", most_of_pair[k]);
    }
    return 0;
}
