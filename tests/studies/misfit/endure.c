/* endure [TICKS]: 20 s of the clean AwAS, then a piece of its last second, at rest, repeated for
 * TICKS, then 2e6 ticks in motion. Prints the estimate after each part.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "setup.h"

enum { MOVING = 20000, ALL = 21000, STILL = 20500 };

static double samples[ALL][4]; /* theta, q, set-point, tau */

static void tick(est *e, int k, est_output *out)
{
    const double *z = samples[k];

    est_tick(e, (sh_real)z[0], (sh_real)z[1], (sh_real)z[2], (sh_real)z[3], out);
}

static void report(const char *when, const est *e, const est_output *out)
{
    const double sigma = (double)out->sigma, std = (double)out->sigma_std;

    printf("%-16s sigma %.4f +- %.4f q %.3f kappa %.2f finite %d\n", when, sigma, std, (double)e->q,
           sqrt((double)e->kappa2), isfinite(sigma) && isfinite(std));
}

int main(int argc, char **argv)
{
    static est e;
    const long n = argc > 1 ? atol(argv[1]) : 1000000;
    sim_parameters p;
    cat_given given;
    sim s;
    est_settings settings;
    est_output out;
    long k;

    cat_make(AWAS, &CAT_CONDITIONS[0], 1, &p, &given);
    sim_start(&s, &p);
    est_defaults(&settings);
    settings.B = (sh_real)given.B;
    settings.D = (sh_real)given.D;
    est_start(&e, &settings);
    for (k = 0; k < ALL; ++k) {
        sim_sample m;

        if (k == MOVING) {
            p.torque.count = 0;
            p.arm.count = 0;
        }
        sim_next(&s, &m);
        samples[k][0] = k > STILL ? samples[STILL][0] : m.theta;
        samples[k][1] = k > STILL ? samples[STILL][1] : m.q;
        samples[k][2] = m.r * 1000;
        samples[k][3] = m.tau;
        tick(&e, (int)k, &out);
    }
    report("after 21 s", &e, &out);
    for (k = 0; k < n; ++k)
        tick(&e, STILL + 100 + (int)(k % 400), &out);
    report("after the rest", &e, &out);
    for (k = 0; k < 2000000; ++k)
        tick(&e, (int)(k % MOVING), &out);
    report("after 2e6 ticks", &e, &out);
    return 0;
}
