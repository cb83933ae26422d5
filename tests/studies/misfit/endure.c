/* endure [TICKS]: 20 s of the clean AwAS, then a piece of its last second, at rest, repeated for
 * TICKS, then 2e6 ticks in motion. Prints the estimate after each part.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "setup.h"

enum { MOVING = 20000, ALL = 21000, STILL = 20500 };

static sim_sample samples[ALL];
static double theta_c[ALL];
static sh_parameters q;

static void tick(sh_estimator *e, int k, sh_estimate *out)
{
    setup_tick(e, &q, &samples[k], theta_c[k], out);
}

static void report(const char *when, const sh_estimate *out)
{
    const double sigma = (double)out->sigma, std = (double)out->sigma_std;

    printf("%-16s sigma %.4f +- %.4f misfit %.3f finite %d\n", when, sigma, std,
           (double)out->misfit, isfinite(sigma) && isfinite(std));
}

int main(int argc, char **argv)
{
    static sh_estimator e;
    const long n = argc > 1 ? atol(argv[1]) : 1000000;
    sim_parameters p;
    cat_given given;
    sim s;
    sh_estimate out;
    long k;

    cat_make(AWAS, &CAT_CONDITIONS[0], 1, &p, &given);
    sim_start(&s, &p);
    setup_parameters(&p, &given, &q);
    sh_estimator_start(&e, &q, &out);
    for (k = 0; k < ALL; ++k) {
        sim_sample m;

        if (k == MOVING) {
            p.torque.count = 0;
            p.arm.count = 0;
        }
        sim_next(&s, &m);
        if (k > STILL) {
            m.theta = samples[STILL].theta;
            m.q = samples[STILL].q;
        }
        samples[k] = m;
        theta_c[k] = setup_theta_c(&p, m.r);
        tick(&e, (int)k, &out);
    }
    report("after 21 s", &out);
    for (k = 0; k < n; ++k) {
        tick(&e, STILL + 100 + (int)(k % 400), &out);
    }
    report("after the rest", &out);
    for (k = 0; k < 2000000; ++k) {
        tick(&e, (int)(k % MOVING), &out);
    }
    report("after 2e6 ticks", &out);
    return 0;
}
