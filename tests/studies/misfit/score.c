/* score FIRST LAST [-c CLASS] [-r ROW] [-j JOINT] [-o key=value] [-v N]
 *
 * The table of misfits, over the seeds FIRST to LAST. For each joint, in per cent: RMS error, RMS
 * of sigma_std, share of instants within 1.96 sigma_std, share that is dangerous (error above 10 %,
 * sigma_std below 2 %), share that is confident, share that is confident and over 20 % wrong; then
 * the mean misfit.
 *
 * -c  one class of catalogue.h
 * -r  rows whose name contains ROW
 * -j  one joint: 0, 1, 2
 * -o  another value of a parameter, see override
 * -v  prints the estimate every N ticks
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "setup.h"

typedef struct {
    double error2, claim2, inside, dangerous, confident, wrong20, wrong10, misfit, n;
} score;

static void add(score *s, double truth, double sigma, double std, int confident)
{
    const double e = fabs(sigma / truth - 1), claim = std / fabs(truth);

    s->error2 += fmin(e * e, 1e2);
    s->claim2 += fmin(claim * claim, 1e2);
    s->inside += fabs(sigma - truth) <= 1.96 * std;
    s->dangerous += e > 0.1 && std / fabs(sigma) < 0.02;
    s->confident += confident;
    s->wrong20 += confident && e > 0.2;
    s->wrong10 += confident && e > 0.1;
    s->n += 1;
}

static void merge(score *a, const score *b)
{
    double *x = (double *)a;
    const double *y = (const double *)b;
    size_t i;

    for (i = 0; i < sizeof *a / sizeof(double); ++i) {
        x[i] += y[i];
    }
}

enum { MAX_OVERRIDES = 40 };
static int n_overrides;
static char *overrides[MAX_OVERRIDES]; /* key=value */

static void override(sh_parameters *q)
{
    const struct {
        const char *name;
        sh_real *value;
    } keys[] = {
        {"prior.torque_gain", &q->prior.torque_gain},
        {"prior.bias", &q->prior.bias},
        {"prior.damping", &q->prior.damping},
        {"prior.load_friction", &q->prior.load_friction},
        {"prior.eccentric", &q->prior.eccentric},
        {"prior.delay", &q->prior.delay},
        {"prior.reversal", &q->prior.reversal},
        {"prior.power", &q->prior.power},
        {"prior.gap", &q->prior.gap},
        {"prior.hysteresis", &q->prior.hysteresis},
        {"prior.eccentric_motor", &q->prior.eccentric_motor},
        {"regression.memory", &q->regression.memory},
        {"regression.slow", &q->regression.slow},
        {"regression.bandwidth", &q->regression.bandwidth},
    };
    size_t k;
    int i;

    for (i = 0; i < n_overrides; ++i) {
        const char *equals = strchr(overrides[i], '=');
        const size_t length = (size_t)(equals - overrides[i]);

        for (k = 0; k < sizeof keys / sizeof keys[0]; ++k) {
            if (strlen(keys[k].name) == length &&
                strncmp(overrides[i], keys[k].name, length) == 0) {
                *keys[k].value = (sh_real)atof(equals + 1);
            }
        }
    }
}

static int trace; /* every so many ticks a line is printed; 0: none */

static void print_trace(double t, const sim_sample *z, const sh_parameters *q, const sh_estimate *e)
{
    printf("%7.3f phi %9.5f sigma %9.2f est %9.2f +- %8.2f misfit %7.3f b %7.4f d %7.4f C %7.4f "
           "bias %7.3f damping %8.4f load %7.4f delay %8.5f hysteresis %7.4f doubt %d\n",
           t, z->phi, z->sigma, (double)e->sigma, (double)e->sigma_std, (double)e->misfit,
           (double)(e->B_hat / q->motor.B - 1), (double)(e->D_theta_hat / q->motor.D_theta - 1),
           (double)e->tau_coulomb_hat, (double)e->bias_hat, (double)e->damping_hat,
           (double)e->load_friction_hat, (double)e->delay_hat, (double)e->hysteresis_hat, e->doubt);
}

static void run(int joint, const cat_condition *c, uint64_t seed, score *found)
{
    static sh_estimator estimator;
    sim_parameters p;
    cat_given given;
    sim plant;
    sh_parameters q;
    sh_estimate estimate;
    const double duration = cat_make(joint, c, seed, &p, &given);
    const int ticks = (int)(duration / p.T + 0.5);
    const double from = p.rest + 2;
    int k;

    if (!(duration > 0)) {
        return;
    }
    sim_start(&plant, &p);
    setup_parameters(&p, &given, &q);
    override(&q);
    sh_estimator_start(&estimator, &q, &estimate);
    for (k = 0; k < ticks; ++k) {
        sim_sample z;

        sim_next(&plant, &z);
        setup_tick(&estimator, &q, &z, setup_theta_c(&p, z.r), &estimate);
        if (trace > 0 && k % trace == 0) {
            print_trace(k * p.T, &z, &q, &estimate);
        }
        if (k * p.T < from || z.in_gap || k % 5 != 0) {
            continue;
        }
        add(found, z.sigma, (double)estimate.sigma, (double)estimate.sigma_std, estimate.confident);
        found->misfit += (double)estimate.misfit;
    }
}

static void print(const score *s)
{
    printf(" %6.2f %6.2f %5.1f %5.1f %5.1f %5.1f |", 100 * sqrt(s->error2 / s->n),
           100 * sqrt(s->claim2 / s->n), 100 * s->inside / s->n, 100 * s->dangerous / s->n,
           100 * s->confident / s->n, 100 * s->wrong20 / s->n);
}

/* What to run. */
typedef struct {
    uint64_t first, last; /* seeds */
    const char *row;      /* part of the names of rows, NULL: all */
    int joint, class_;    /* -1: all */
} options;

/* Sums over the rows of a class. */
typedef struct {
    double coverage[JOINTS], errors[JOINTS], rows[JOINTS]; /* [%], [%], [1] */
    score all;
} summary;

static void run_row(const options *o, const cat_condition *c, summary *sum)
{
    int joint;

    printf("%d %-30s", c->class_, c->name);
    for (joint = 0; joint < JOINTS; ++joint) {
        score found;
        uint64_t seed;

        if (o->joint >= 0 && joint != o->joint) {
            continue;
        }
        memset(&found, 0, sizeof found);
        for (seed = o->first; seed <= o->last; ++seed) {
            run(joint, c, seed, &found);
        }
        if (!(found.n > 0)) {
            printf(" %44s|", "");
            continue;
        }
        print(&found);
        printf(" %5.2f |", found.misfit / found.n);
        sum->coverage[joint] += 100 * found.inside / found.n;
        sum->errors[joint] += 100 * sqrt(found.error2 / found.n);
        sum->rows[joint] += 1;
        merge(&sum->all, &found);
    }
    printf("\n");
    fflush(stdout);
}

static void print_summary(int class_, const summary *s)
{
    const score *all = &s->all;
    int joint;

    if (!(all->n > 0)) {
        return;
    }
    printf("class %d:", class_);
    for (joint = 0; joint < JOINTS; ++joint) {
        if (s->rows[joint] > 0) {
            printf("  %s rows %2.0f mean error %5.2f coverage %5.1f", CAT_JOINTS[joint],
                   s->rows[joint], s->errors[joint] / s->rows[joint],
                   s->coverage[joint] / s->rows[joint]);
        }
    }
    printf("  dangerous %.2f wrong20 %.3f wrong10 %.3f confident %.1f\n",
           100 * all->dangerous / all->n, 100 * all->wrong20 / all->n, 100 * all->wrong10 / all->n,
           100 * all->confident / all->n);
}

/* Returns 0 if the arguments are not as described at the top. */
static int parse(int argc, char **argv, options *o)
{
    int i;

    o->row = NULL;
    o->joint = o->class_ = -1;
    if (argc < 3) {
        return 0;
    }
    o->first = strtoull(argv[1], NULL, 10);
    o->last = strtoull(argv[2], NULL, 10);
    for (i = 3; i < argc; ++i) {
        if (i + 1 >= argc) {
            return 0;
        }
        if (strcmp(argv[i], "-r") == 0) {
            o->row = argv[++i];
        } else if (strcmp(argv[i], "-j") == 0) {
            o->joint = atoi(argv[++i]);
        } else if (strcmp(argv[i], "-c") == 0) {
            o->class_ = atoi(argv[++i]);
        } else if (strcmp(argv[i], "-v") == 0) {
            trace = atoi(argv[++i]);
        } else if (strcmp(argv[i], "-o") == 0 && n_overrides < MAX_OVERRIDES &&
                   strchr(argv[i + 1], '=')) {
            overrides[n_overrides++] = argv[++i];
        } else {
            return 0;
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    static summary classes[CLASSES];
    options o;
    int i;

    if (!parse(argc, argv, &o)) {
        fprintf(stderr, "expected: score FIRST LAST [-c CLASS] [-r ROW] [-j JOINT] "
                        "[-o key=value] [-v N]\n");
        return 1;
    }
    printf("%-32s   error  claim cover  dang  conf >20%%\n", "");
    for (i = 0; i < CAT_COUNT; ++i) {
        const cat_condition *c = &CAT_CONDITIONS[i];

        if ((!o.row || strstr(c->name, o.row)) && (o.class_ < 0 || c->class_ == o.class_)) {
            run_row(&o, c, &classes[c->class_]);
        }
    }
    for (i = 0; i < CLASSES; ++i) {
        print_summary(i, &classes[i]);
    }
    return 0;
}
