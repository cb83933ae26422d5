/* late [MEMORY]: a misfit that begins at 30 s, and one that ends at 30 s, on each joint. Prints
 * when it is noticed, when the estimate is not confident, and RMS error and claim of each 10 s.
 * MEMORY is regression.memory [s].
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "setup.h"

enum { TENS = 9, RIPPLE = 0, LOAD_FRICTION, DELAYED, STRIBECK, MISFITS };

static const char *const NAMES[] = {"ripple", "load friction", "late", "Stribeck"};

typedef struct {
    double error[TENS], claim[TENS], n[TENS]; /* sums of squares, number of samples */
    double kappa2_before;                     /* at 30 s */
    double noticed;    /* time from 30 s until kappa has grown, -1: never [s] */
    double lost, back; /* first and last time without confidence after 30 s, -1: none [s] */
    int wrong;         /* ticks that are confident and more than 20 % wrong */
} course;

static void add_misfit(int misfit, int joint, sim_parameters *p)
{
    if (misfit == RIPPLE) {
        p->ripple = 0.05 * (joint == AWAS ? 0.4 : 0.35);
        p->ripple_order = 6;
    } else if (misfit == LOAD_FRICTION) {
        p->load_friction = 0.2;
        p->uneven = 0.3;
    } else if (misfit == DELAYED) {
        p->late = 5e-3;
    } else {
        p->stribeck = 1;
    }
}

static void watch(course *c, int k, const sh_estimator *e, const sh_estimate *out, double sigma)
{
    const double t = k * 1e-3, error = (double)out->sigma / sigma - 1;
    const int ten = (int)(t / 10);

    if (t > 2) {
        c->error[ten] += error * error;
        c->claim[ten] += pow((double)out->sigma_std / sigma, 2);
        c->n[ten] += 1;
        c->wrong += out->confident && fabs(error) > 0.2;
    }
    if (k == 30000) {
        c->kappa2_before = (double)e->method.regression.variance_factor;
    }
    if (!(t > 30)) {
        return;
    }
    if (c->noticed < 0 &&
        (double)e->method.regression.variance_factor > 1.5 * c->kappa2_before + 0.5) {
        c->noticed = t - 30;
    }
    if (!out->confident) {
        if (c->lost < 0) {
            c->lost = t - 30;
        }
        c->back = t - 30;
    }
}

static void run(int misfit, int ends, int joint, double memory)
{
    static sh_estimator e;
    sim_parameters p;
    cat_given given;
    sh_parameters q;
    sh_estimate out;
    sim plant;
    course c;
    int k;

    cat_make(joint, &CAT_CONDITIONS[0], 1, &p, &given);
    add_misfit(misfit, joint, &p);
    p.on = ends ? -1 : 30;
    p.off = ends ? 30 : 1e9;
    sim_start(&plant, &p);
    setup_parameters(&p, &given, &q);
    q.prior.torque_gain = 0;
    if (memory > 0) {
        q.regression.memory = (sh_real)memory;
    }
    sh_estimator_start(&e, &q, &out);
    memset(&c, 0, sizeof c);
    c.noticed = c.lost = c.back = -1;
    for (k = 0; k < 90000; ++k) {
        sim_sample z;

        sim_next(&plant, &z);
        setup_tick(&e, &q, &z, setup_theta_c(&p, z.r), &out);
        watch(&c, k, &e, &out, z.sigma);
    }
    printf("%s %s, %s: kappa at 30 s %.1f, noticed after %.2f s, not confident from %.2f to %.2f "
           "s after, wrong by 20 %% in %d ticks, kappa at the end %.1f, error/claim %%:",
           NAMES[misfit], ends ? "ends" : "begins", CAT_JOINTS[joint], sqrt(c.kappa2_before),
           c.noticed, c.lost, c.back, c.wrong, sqrt((double)e.method.regression.variance_factor));
    for (k = 0; k < TENS; ++k) {
        printf(" %.2f/%.2f", 100 * sqrt(c.error[k] / c.n[k]), 100 * sqrt(c.claim[k] / c.n[k]));
    }
    printf("\n");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    const double memory = argc > 1 ? atof(argv[1]) : 0;
    int misfit, ends, joint;

    for (misfit = 0; misfit < MISFITS; ++misfit) {
        for (ends = 0; ends < 2; ++ends) {
            for (joint = 0; joint < JOINTS; ++joint) {
                run(misfit, ends, joint, memory);
            }
        }
    }
    return 0;
}
