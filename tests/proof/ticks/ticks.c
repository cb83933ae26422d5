/* Instructions of the longest of many ticks, to compare with the bounds of docs/proof/bounds.md.
 *
 * Each line: method, rls.n, rls.m, number of columns, instructions of the longest tick. The joint has
 * friction that grows, and a torque that no model explains, so that the estimator does all it can do.
 */
#include <math.h>
#include <stdio.h>

#include "hardware.h"
#include "sigmahat.h"

enum { TICKS = 1600, GROWTH = 800 };

static sh_parameters parameters;
static sh_estimator estimator;
static sh_estimate estimate;
static sh_measurement z;

static void tick(void)
{
    sh_estimator_tick(&estimator, &parameters, &z, &estimate);
}

/* A loop of 2 instructions per turn, to measure the counts of the clock per instruction. */
static void loop(void)
{
    uint32_t turns = 100000;

    __asm volatile("1: subs %0, #1\n\tbne 1b" : "+r"(turns)::"cc");
}

/* Counts of the clock that a function takes; the clock has 24 bits and counts down. */
static uint32_t counts(void (*function)(void))
{
    const uint32_t before = hardware_clock();

    function();
    return (before - hardware_clock()) & 0xffffffu;
}

/* Sample k: a motor that swings. */
static void measure(int k)
{
    const double T = (double)parameters.samplePeriod, t = k * T, w = 7.0;
    const double friction = k > GROWTH ? 2.0 : 0.02;
    const double theta = 0.5 * sin(w * t) + 0.2 * sin(1.7 * w * t);
    const double phi = 0.1 * sin(w * t);

    z.theta = (sh_real)theta;
    z.theta_c = (sh_real)sin(0.3 * t);
    z.tau = (sh_real)((cos(w * t) > 0 ? friction : -friction) + 0.1 * sin(31.0 * t) - 3 * phi);
    z.q = (sh_real)(theta + phi);
}

/* Every column, and every part of a tick that parameters switch on. */
static void use_everything(sh_parameters *p)
{
    sh_real *const prior = &p->prior.tau_e;
    const int priors = (int)(sizeof p->prior / sizeof *prior);
    int i;

    for (i = 0; i < priors; ++i) {
        prior[i] = prior[i] > 0 ? prior[i] : (sh_real)0.1;
    }
    p->rls.n = SH_MAX_N;
    p->rls.m = SH_MAX_M;
    p->rls.eta_0[0][0] = 10;
    p->samplePeriod = (sh_real)0.0125;
    p->regression.bandwidth = 40;
    p->deformation = SH_DEFORMATION_FILTERED;
    p->residual.K_I = 50;
}

static void report(int method, uint32_t per_loop)
{
    sh_violation violation;
    uint32_t longest = 0;
    int k;

    parameters.method = method;
    if (sh_parameters_check(&parameters, &violation)) {
        printf("%s: expected %s\n", violation.name, violation.range);
        return;
    }
    sh_estimator_start(&estimator, &parameters, &estimate);
    for (k = 0; k < TICKS; ++k) {
        uint32_t now;

        measure(k);
        now = counts(tick);
        longest = now > longest ? now : longest;
    }
    printf("%d %d %d %d %.0f\n", method, parameters.rls.n, parameters.rls.m,
           method == SH_METHOD_PAPER2011 ? 0 : estimator.method.regression.columns.size,
           200000.0 * longest / per_loop);
}

int main(void)
{
    uint32_t per_loop;

    hardware_start_clock();
    per_loop = counts(loop);
    sh_parameters_default(&parameters);
    report(SH_METHOD_PAPER2011, per_loop);
    report(SH_METHOD_FILTERED_REGRESSION, per_loop);
    use_everything(&parameters);
    report(SH_METHOD_PAPER2011, per_loop);
    report(SH_METHOD_FILTERED_REGRESSION, per_loop);
    return 0;
}
