/* sines table SEEDS [MODE [REVERSAL]], sines cells RUNS [MODE [REVERSAL]]: single sines on the
 * AwAS, FilteredRegression without the columns for misfits -> MODE, as in docs/filtered-regression.md.
 *
 * table     the table of frequencies and wrong motor data
 * cells     errors of the motor data drawn from their priors, by frequency and friction
 * MODE      0: all columns, 1: new columns off, 2: no candidates
 * REVERSAL  prior.reversal [s], 2e-3 if it is left out; 0: no such column
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "setup.h"

/* Sums over instants; d, b and C over runs. */
typedef struct {
    double msrep, n;              /* squared errors, times 100 */
    double claim2, inside, after; /* instants once the priors have had their effect */
    double b, C;
} sums;

/* What the estimators are given. */
typedef struct {
    double D, B, prior_D, prior_B, prior_C;
    double from; /* instants before are not in the MSREP [s] */
} motor;

enum { ALL, NONE, NO_CANDIDATES };

static int mode;
static double reversal = 2e-3;

static void add(sums *s, double t, double from, double truth, double sigma, double std)
{
    const double error = sigma / truth - 1;

    if (t >= from) {
        s->msrep += 100 * error * error;
        s->n += 1;
    }
    if (t >= 2) {
        s->inside += fabs(sigma - truth) <= 1.96 * std;
        s->claim2 += std * std / truth / truth;
        s->after += 1;
    }
}

static void start(const motor *given, int columns, sh_parameters *p)
{
    sh_parameters_default(p);
    p->method = SH_METHOD_FILTERED_REGRESSION;
    p->rls.n = 3;
    p->motor.D_theta = (sh_real)given->D;
    p->motor.B = (sh_real)given->B;
    p->prior.D_theta = (sh_real)given->prior_D;
    p->prior.B = (sh_real)given->prior_B;
    p->prior.tau_coulomb = (sh_real)given->prior_C;
    p->prior.torque_gain = 0;
    p->prior.reversal = (sh_real)reversal;
    if (columns != ALL) {
        setup_without_candidates(p);
    }
    if (columns == NONE) {
        setup_without_new_columns(p);
        p->regression.memory = 0;
    }
}

static void run(const sim_parameters *p, const motor *given, sums *without, sums *with)
{
    static sh_estimator estimator[2];
    sh_parameters q[2];
    sh_estimate estimate[2];
    sums *const both[] = {without, with};
    sim plant;
    int k, i;

    sim_start(&plant, p);
    for (i = 0; i < 2; ++i) {
        start(given, i == 0 ? NONE : mode, &q[i]);
        sh_estimator_start(&estimator[i], &q[i], &estimate[i]);
    }
    for (k = 0; k <= 15000; ++k) {
        sim_sample z;

        sim_next(&plant, &z);
        for (i = 0; i < 2; ++i) {
            setup_tick(&estimator[i], &q[i], &z, setup_theta_c(p, z.r), &estimate[i]);
            add(both[i], k * 1e-3, given->from, z.sigma, (double)estimate[i].sigma,
                (double)estimate[i].sigma_std);
        }
    }
    for (i = 0; i < 2; ++i) {
        both[i]->b += (double)estimate[i].B_hat / p->B;
        both[i]->C += (double)estimate[i].tau_coulomb_hat;
    }
}

static double amplitude(double f)
{
    return f < 5 ? 0.3 : 0.5;
}

static void table(int seeds)
{
    static const double FREQUENCIES[] = {0.1, 0.3, 1, 3, 8, 20};
    static const struct {
        const char *name;
        double coulomb;
        motor given;
    } VARIANTS[] = {
        {"D +10 %, no friction", 0, {1.1e-3, 2.3e-5, 0.2, 0, 0, 0}},
        {"D -10 %, no friction", 0, {0.9e-3, 2.3e-5, 0.2, 0, 0, 0}},
        {"friction 0.02, D +10 %", 0.02, {1.1e-3, 2.3e-5, 0.2, 0, 0.02, 1}},
        {"friction 0.02, D +10 %, B +10 %", 0.02, {1.1e-3, 1.1 * 2.3e-5, 0.2, 0.1, 0.02, 1}},
    };
    int v, i, seed;

    for (v = 0; v < 4; ++v) {
        printf("%s\n", VARIANTS[v].name);
        for (i = 0; i < 6; ++i) {
            const double f = FREQUENCIES[i];
            sums t, n;
            double factor;

            memset(&t, 0, sizeof t);
            memset(&n, 0, sizeof n);
            for (seed = 1; seed <= seeds; ++seed) {
                sim_parameters p;

                setup_sine(&p, f, amplitude(f), VARIANTS[v].coulomb, (uint64_t)seed);
                run(&p, &VARIANTS[v].given, &t, &n);
            }
            factor = n.msrep / n.n / (t.msrep / t.n);
            printf("%5.1f Hz  MSREP %9.4f -> %9.4f (x%5.2f) rms x%4.2f  claim %6.2f -> %6.2f  "
                   "within %5.1f -> %5.1f  B %.3f -> %.3f C %.4f -> %.4f\n",
                   f, t.msrep / t.n, n.msrep / n.n, factor, sqrt(factor),
                   100 * sqrt(t.claim2 / t.after), 100 * sqrt(n.claim2 / n.after),
                   100 * t.inside / t.after, 100 * n.inside / n.after, t.b / seeds, n.b / seeds,
                   t.C / seeds, n.C / seeds);
            fflush(stdout);
        }
    }
}

/* One cell: a frequency [Hz] and a range of friction [N.m]. */
static void cell(int runs, uint64_t key, double f, double low, double high, int with_B)
{
    sums t, n;
    int k, j;

    memset(&t, 0, sizeof t);
    memset(&n, 0, sizeof n);
    for (k = 0; k < runs; ++k) {
        uint64_t random = key + (uint64_t)k;
        motor given = {0, 2.3e-5, 0.2, 0, 0.02, 1};
        sim_parameters p;
        double d, b, C;

        for (j = 0; j < 3; ++j) {
            sim_uniform(&random);
        }
        d = 0.2 * sim_gauss(&random);
        b = 0.1 * sim_gauss(&random);
        C = low + (high - low) * sim_uniform(&random);
        given.D = 1e-3 / (1 + d);
        if (with_B) {
            given.B = 2.3e-5 / (1 + b);
            given.prior_B = 0.1;
        }
        setup_sine(&p, f, amplitude(f), C, (uint64_t)(k + 1));
        run(&p, &given, &t, &n);
    }
    printf("   within %5.1f -> %5.1f rms %5.2f -> %5.2f claim %5.2f -> %5.2f",
           100 * t.inside / t.after, 100 * n.inside / n.after, 10 * sqrt(t.msrep / t.n),
           10 * sqrt(n.msrep / n.n), 100 * sqrt(t.claim2 / t.after),
           100 * sqrt(n.claim2 / n.after));
    fflush(stdout);
}

static void cells(int runs)
{
    static const double FREQUENCIES[] = {0.3, 1, 3, 8}, FRICTION[] = {0, 0.005, 0.02, 0.05};
    int i, c, with_B;

    for (with_B = 0; with_B < 2; ++with_B) {
        for (i = 0; i < 4; ++i) {
            printf("%s %4.1f Hz:", with_B ? "with B" : "      ", FREQUENCIES[i]);
            for (c = 0; c < 3; ++c) {
                cell(runs, (uint64_t)(1000 * c + 10000 * i + 100000 * with_B), FREQUENCIES[i],
                     FRICTION[c], FRICTION[c + 1], with_B);
            }
            printf("\n");
        }
    }
}

int main(int argc, char **argv)
{
    const int is_table = argc > 2 && strcmp(argv[1], "table") == 0;

    if (argc < 3 || (!is_table && strcmp(argv[1], "cells") != 0)) {
        fprintf(stderr, "expected: sines table SEEDS [MODE [REVERSAL]] or sines cells RUNS ...\n");
        return 1;
    }
    mode = argc > 3 ? atoi(argv[3]) : 0;
    if (argc > 4) {
        reversal = atof(argv[4]);
    }
    if (is_table) {
        table(atoi(argv[2]));
    } else {
        cells(atoi(argv[2]));
    }
    return 0;
}
