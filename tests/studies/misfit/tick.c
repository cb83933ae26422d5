/* tick: time of a tick of MatchedFilter and of the prototype, for several numbers of parameters.
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
    if (run == 0 || time < least[k])
        least[k] = time;
}

static void report(const char *name, int p)
{
    const int n = N - FIRST;
    double mean = 0;
    int k;

    for (k = FIRST; k < N; ++k)
        mean += least[k] / n;
    qsort(least + FIRST, (size_t)n, sizeof *least, by_size);
    printf("%-24s p %2d mean %7.0f ns median %7.0f  99.9 %% %7.0f  worst %7.0f\n", name, p, mean,
           least[FIRST + n / 2], least[FIRST + (int)(n * 0.999)], least[N - 1]);
}

static void time_today(int n, int m)
{
    static sh_estimator estimator;
    sh_parameters p;
    sh_estimate estimate;
    int run, k;

    sh_parameters_default(&p);
    p.method = SH_METHOD_MATCHED_FILTER;
    p.rls.n = n;
    p.rls.m = m;
    p.prior.B = (sh_real)0.1;
    for (run = 0; run < RUNS; ++run) {
        sh_estimator_start(&estimator, &p, &estimate);
        for (k = 0; k < N; ++k) {
            const double start = now();

            setup_tick(&estimator, &p, &samples[k], theta_c[k], &estimate);
            keep(run, k, now() - start);
        }
    }
    report("MatchedFilter", n * m + 3);
}

static void time_prototype(const char *name, const est_settings *s)
{
    static est e;
    est_output out;
    int run, k;

    for (run = 0; run < RUNS; ++run) {
        est_start(&e, s);
        for (k = 0; k < N; ++k) {
            const sim_sample *z = &samples[k];
            const double start = now();

            est_tick(&e, (sh_real)z->theta, (sh_real)z->q, (sh_real)setup_set_point(theta_c[k]),
                     (sh_real)z->tau, &out);
            keep(run, k, now() - start);
        }
    }
    report(name, e.columns);
}

int main(void)
{
    est_settings s;
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
    time_today(3, 3);
    time_today(6, 3);
    time_today(8, 3);
    est_defaults(&s);
    setup_without_candidates(&s);
    setup_without_new_columns(&s);
    time_prototype("new columns off", &s);
    est_defaults(&s);
    setup_without_candidates(&s);
    time_prototype("no candidates", &s);
    est_defaults(&s);
    time_prototype("all columns", &s);
    s.n = 4;
    time_prototype("all columns, n = 4", &s);
    printf("bytes: MatchedFilter %d, prototype %d (TRI_MAX %d)\n", (int)sizeof(sh_estimator),
           (int)sizeof(est), TRI_MAX);
    return 0;
}
