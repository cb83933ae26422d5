/* tick: time of a tick of both methods, for several numbers of columns.
 * The time of a tick is the least of all runs; over the ticks, the mean and the worst are printed.
 */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "setup.h"

enum { N = 20000, FIRST = 2000, RUNS = 15 };

static sim_sample samples[N];
static double theta_c[N], least[N]; /* [rad], [ns] */

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static void keep(int run, int k, double time)
{
    if (run == 0 || time < least[k]) {
        least[k] = time;
    }
}

static void report(const char *name, int p)
{
    const int n = N - FIRST;
    double mean = 0;
    int k;

    for (k = FIRST; k < N; ++k) {
        mean += least[k] / n;
    }
    qsort(least + FIRST, (size_t)n, sizeof *least, by_size);
    printf("%-24s p %2d mean %7.0f ns median %7.0f  99.9 %% %7.0f  worst %7.0f\n", name, p, mean,
           least[FIRST + n / 2], least[FIRST + (int)(n * 0.999)], least[N - 1]);
}

static void time_ticks(const char *name, const sh_parameters *p, int columns)
{
    static sh_estimator estimator;
    sh_estimate estimate;
    int run, k;

    for (run = 0; run < RUNS; ++run) {
        sh_estimator_start(&estimator, p, &estimate);
        for (k = 0; k < N; ++k) {
            const double start = now();

            setup_tick(&estimator, p, &samples[k], theta_c[k], &estimate);
            keep(run, k, now() - start);
        }
    }
    report(name, columns > 0 ? columns : estimator.method.regression.size);
}

int main(void)
{
    sh_parameters q;
    sim_parameters p;
    cat_given given;
    sim plant;
    int k;

    cat_make(AWAS, &CAT_CONDITIONS[0], 1, &p, &given);
    sim_start(&plant, &p);
    for (k = 0; k < N; ++k) {
        sim_next(&plant, &samples[k]);
        theta_c[k] = setup_theta_c(&p, samples[k].r);
    }
    sh_parameters_default(&q);
    time_ticks("Paper2011", &q, q.rls.n * q.rls.m);
    q.method = SH_METHOD_FILTERED_REGRESSION;
    q.rls.n = 3;
    q.prior.B = (sh_real)0.1;
    time_ticks("all columns", &q, 0);
    q.rls.n = 4;
    time_ticks("all columns, n = 4", &q, 0);
    q.rls.n = 3;
    setup_without_candidates(&q);
    time_ticks("no candidates", &q, 0);
    setup_without_new_columns(&q);
    time_ticks("torque and motor alone", &q, 0);
    printf("bytes: %d\n", (int)sizeof(sh_estimator));
    return 0;
}
