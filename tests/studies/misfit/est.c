#include "est.h"

#include <string.h>

#include "real_math.h"

#define sh_cos SH_FOR(SH_REAL, cos, cosf)
#define sh_floor SH_FOR(SH_REAL, floor, floorf)
#define sh_log SH_FOR(SH_REAL, log, logf)

enum {
    BASIS,
    NOMINAL,
    BIAS,
    LAG,
    LOAD,
    SIN_Q,
    COS_Q,
    DELAY,
    REVERSAL,
    POWER,
    SETPOWER,
    CLIP,
    PLAY,
    SIN_M,
    COS_M,
    VISCOUS,
    COULOMB,
    INERTIA,
    KINDS
};

enum { G_POWER = 1, G_SET, G_CLIP, G_PLAY, G_MOTOR };

static const sh_real FORGOTTEN = 12;        /* time constants 1/w */
static const sh_real BLOCK = (sh_real)0.05; /* [s] */
/* Half widths of dead zones and of plays, of range.phi. */
static const sh_real CLIPS[EST_PLAYS] = {(sh_real)0.01, (sh_real)0.04, (sh_real)0.16};
static const sh_real PLAYS[EST_PLAYS] = {(sh_real)0.005, (sh_real)0.02, (sh_real)0.08};
/* Share of the excess of noise after the filter by which samples weigh less. */
static const sh_real EXCESS = (sh_real)0.3;
static const sh_real KNOWN = (sh_real)0.2; /* relative uncertainty below which the columns that
                                           need the stiffness have an effect */
/* Precision, in units of the prior's, with which data begin. Not 0: if the other
 * columns make up a column exactly, its pivot would consist of rounding errors only.
 */
#define TINY SH_FOR(SH_REAL, 1e-9, 1e-5f)
/* Variance by which friction may drift in a second, in units of the prior's. Friction may drift
 * only if the data then contradict the model less.
 */
static const sh_real WALK = (sh_real)1e-3;
enum { FIRST_BLOCKS = 20 };

static sh_real sq(sh_real x)
{
    return x * x;
}

static sh_real clamp(sh_real x, sh_real limit)
{
    return sh_fmin(sh_fmax(x, -limit), limit);
}

void est_defaults(est_settings *s)
{
    memset(s, 0, sizeof *s);
    s->T = (sh_real)1e-3;
    s->bandwidth = 350;
    s->slow = (sh_real)0.05;
    s->memory = 20;
    s->symmetric = 1;
    s->n = 3;
    s->m = 3;
    s->range_phi = (sh_real)0.3;
    s->range_set = 100;
    s->noise = (sh_real)3.2e-3;
    s->gamma = 50;
    s->B = (sh_real)2.3e-5;
    s->D = (sh_real)1e-3;
    s->count = s->count_q = (sh_real)(2 * SH_PI / 40000);
    s->confidence = (sh_real)0.1;
    s->prior.tau_e = 45;
    s->prior.D = (sh_real)0.2;
    s->prior.B = (sh_real)0.1;
    s->prior.tau_coulomb = (sh_real)0.02;
    s->prior.torque_gain = (sh_real)0.02;
    s->prior.bias = (sh_real)0.05;
    s->prior.lag = (sh_real)7.5e-3;
    s->prior.load_friction = (sh_real)0.1;
    s->prior.eccentric = (sh_real)5e-4;
    s->prior.delay = (sh_real)2e-3;
    s->prior.reversal = (sh_real)2e-3;
    s->prior.power = 1;
    s->prior.gap = (sh_real)0.02;
    s->prior.hysteresis = (sh_real)0.01;
    s->prior.eccentric_motor = (sh_real)1e-4;
}

/* ---- columns ------------------------------------------------------------------------------ */

static void add(est *e, int kind, int index, int group, sh_real prior)
{
    est_column *c = &e->column[e->columns];

    if (!(prior > 0) || e->columns >= TRI_MAX)
        return;
    c->kind = kind;
    c->index = index;
    c->group = group;
    c->prior = prior;
    c->torque =
        kind == BASIS || kind == POWER || kind == CLIP || kind == NOMINAL || kind == SETPOWER;
    if (e->place[kind] < 0)
        e->place[kind] = e->columns;
    e->columns += 1;
}

/* All possible columns, in the order of the data: B last, C before it. */
static void make_columns(est *e)
{
    const est_settings *s = &e->s;
    const int motor = !s->measured;
    const sh_real K_0 = s->prior.tau_e / s->range_phi;
    int i;

    for (i = 0; i < EST_KINDS; ++i)
        e->place[i] = -1;
    for (i = 0; i < s->n * s->m; ++i)
        add(e, BASIS, i, 0, s->prior.tau_e);
    add(e, NOMINAL, 0, 0, s->prior.nominal);
    add(e, BIAS, 0, 0, s->prior.bias * s->prior.tau_e);
    add(e, LAG, 0, 0, s->prior.lag * K_0);
    if (s->m > 1)
        add(e, LAG, s->m - 1, 0, s->prior.lag * K_0);
    add(e, SIN_Q, 0, 0, s->prior.eccentric * K_0);
    add(e, COS_Q, 0, 0, s->prior.eccentric * K_0);
    if (motor) {
        add(e, LOAD, 0, 0, s->prior.load_friction);
        add(e, DELAY, 0, 0, s->prior.delay * sh_fabs(s->gamma));
        add(e, REVERSAL, 0, 0, s->prior.reversal * s->prior.tau_coulomb * sh_fabs(s->gamma));
    }
    for (i = 0; i < 2; ++i)
        add(e, POWER, i, G_POWER, s->prior.power * s->prior.tau_e);
    if (s->m > 1)
        add(e, SETPOWER, 0, G_SET, s->prior.power * s->prior.tau_e);
    for (i = 0; i < EST_PLAYS; ++i)
        if (CLIPS[i] > 0)
            add(e, CLIP, i, G_CLIP, s->prior.gap * s->prior.tau_e);
    for (i = 0; i < EST_PLAYS; ++i)
        if (PLAYS[i] > 0)
            add(e, PLAY, i, G_PLAY, s->prior.hysteresis * s->prior.tau_e);
    if (motor) {
        add(e, SIN_M, 0, G_MOTOR, s->prior.eccentric_motor);
        add(e, COS_M, 0, G_MOTOR, s->prior.eccentric_motor);
        add(e, VISCOUS, 0, 0, s->prior.D);
        add(e, COULOMB, 0, 0, s->prior.tau_coulomb);
        add(e, INERTIA, 0, 0, s->prior.B);
    }
}

/* x^power / power of the deformation and its derivative, times l^j. */
static void power_of(const est_settings *s, int i, int j, sh_real x, sh_real l, sh_real *F,
                     sh_real *dF)
{
    const int e = s->symmetric ? 2 * i + 1 : i;
    sh_real upper = 1, of_l = 1;
    int k;

    for (k = 0; k < j; ++k)
        of_l *= l;
    for (k = 1; k < e; ++k)
        upper *= x;
    *F = e > 0 ? of_l * upper * x / (sh_real)e : of_l;
    *dF = e > 0 ? of_l * upper / s->range_phi : 0;
}

/* The input of the filter of each column, times its prior, and its part of the stiffness. */
static void make_inputs(est *e, sh_real theta, sh_real q, sh_real phi, sh_real set_point)
{
    const est_settings *s = &e->s;
    const sh_real x = phi / s->range_phi, l = set_point / s->range_set;
    sh_real *in = e->work.in, *dF = e->work.dF;
    int j;

    for (j = 0; j < e->columns; ++j) {
        const est_column *c = &e->column[j];
        sh_real F = 0, d = 0, h;
        int i;

        switch (c->kind) {
        case BASIS: /* from the columns before: those with one power of l less */
            if (c->index < s->n) {
                power_of(s, c->index, 0, x, l, &F, &d);
            } else {
                F = in[j - s->n] * l / c->prior;
                d = dF[j - s->n] * l / c->prior;
            }
            break;
        case NOMINAL:
            for (i = 0; i < s->n * s->m; ++i) {
                sh_real one, slope;
                power_of(s, i % s->n, i / s->n, x, l, &one, &slope);
                F += s->eta_0[i] * one;
                d += s->eta_0[i] * slope;
            }
            break;
        case POWER:
            power_of(s, s->n + c->index, 0, x, l, &F, &d);
            break;
        case SETPOWER:
            power_of(s, s->symmetric ? 0 : 1, s->m, x, l, &F, &d);
            break;
        case CLIP:
            h = CLIPS[c->index] * s->range_phi;
            F = clamp(phi, h) / h;
            d = 0; /* sigma is the slope of the spring where it is engaged */
            break;
        case PLAY:
            F = e->play[c->index] / (PLAYS[c->index] * s->range_phi);
            break;
        case BIAS:
            F = 1;
            break;
        case LAG: /* as the spring, it may depend on the set-point */
            F = phi;
            for (i = 0; i < c->index; ++i)
                F *= l;
            break;
        case SIN_Q:
            F = sh_sin(q);
            break;
        case COS_Q:
            F = sh_cos(q);
            break;
        case SIN_M:
            F = sh_sin(s->gamma * theta);
            break;
        case COS_M:
            F = sh_cos(s->gamma * theta);
            break;
        default:
            break;
        }
        in[j] = F * c->prior;
        dF[j] = d * c->prior;
    }
}

/* Half of the range that the deformation has covered. Dead zones and plays wider than half of it
 * look like the spring, and are left out.
 */
static void watch_span(est *e, sh_real phi)
{
    e->least = sh_fmin(e->least, phi);
    e->most = sh_fmax(e->most, phi);
    e->span = (e->most - e->least) / 2;
}

static void move_plays(est *e, sh_real change)
{
    int i;

    for (i = 0; i < EST_PLAYS; ++i)
        e->play[i] = clamp(e->play[i] + change, PLAYS[i] * e->s.range_phi);
}

/* ---- filters ------------------------------------------------------------------------------ */

static void begin_filters(est *e, sh_real theta, sh_real torque)
{
    int j;

    sh_state_variable_filter_start(&e->theta, theta);
    sh_state_variable_filter_begin(&e->torque, torque);
    sh_state_variable_filter_start(&e->friction, 0);
    sh_state_variable_filter_start(&e->unknown, 0);
    for (j = 0; j < e->columns; ++j) {
        const int kind = e->column[j].kind;
        if (kind == LAG || kind == SIN_M || kind == COS_M || kind == LOAD)
            sh_state_variable_filter_start(&e->filter[j], e->work.in[j]);
        else
            sh_state_variable_filter_begin(&e->filter[j], e->work.in[j]);
    }
    sh_motion_sign_start(&e->motion, theta);
    for (j = 0; j < 5; ++j)
        e->last[j] = theta;
}

/* Estimated torque of the spring, from the inputs of its columns. */
static sh_real curve(const est *e)
{
    sh_real sum = 0;
    int j;

    for (j = 0; j < e->columns; ++j)
        if (e->column[j].torque)
            sum += e->work.in[j] * e->beta[j];
    return sum;
}

static void filter(est *e, sh_real theta, sh_real torque)
{
    const est_settings *s = &e->s;
    int j;

    for (j = 4; j > 0; --j)
        e->last[j] = e->last[j - 1];
    e->last[0] = theta;
    sh_state_variable_filter_step(&e->theta, &e->design, theta);
    sh_state_variable_filter_step(&e->torque, &e->design, torque);
    sh_motion_sign_step(&e->motion, theta, s->count, s->slow * s->T);
    e->unsure = e->motion.unknown > 0 ? e->unsure + 1 : 0;
    sh_state_variable_filter_step_mean(&e->friction, &e->design, e->motion.sign);
    sh_state_variable_filter_step_mean(&e->unknown, &e->design, e->motion.unknown);
    for (j = 0; j < e->columns; ++j) {
        switch (e->column[j].kind) {
        case LOAD:
            sh_state_variable_filter_step_mean(&e->filter[j], &e->design,
                                               -sh_fabs(e->known ? curve(e) : e->y) *
                                                   e->motion.sign * e->column[j].prior);
            break;
        case DELAY:
        case REVERSAL:
        case VISCOUS:
        case COULOMB:
        case INERTIA:
            break;
        default:
            sh_state_variable_filter_step(&e->filter[j], &e->design, e->work.in[j]);
        }
    }
}

static sh_real beside_smooth(const sh_state_variable_filter *f, const sh_filter_design *design)
{
    return sh_state_variable_filter_output(f) +
           sq(design->T) / 12 * sh_state_variable_filter_second(f, design);
}

/* The regression of this sample: columns, then the right-hand sides u (the change of y with the
 * gain of the torque) and y.
 */
static void regression(est *e, sh_real *x)
{
    const est_settings *s = &e->s;
    const sh_filter_design *design = &e->design;
    const sh_real viscous = sq(s->gamma) * s->D * sh_state_variable_filter_first(&e->theta, design);
    const sh_real inertial =
        sq(s->gamma) * s->B * sh_state_variable_filter_second(&e->theta, design);
    const sh_real torque = s->measured ? sh_state_variable_filter_output(&e->torque)
                                       : -s->gamma * beside_smooth(&e->torque, design);
    int j;

    for (j = 0; j < e->columns; ++j) {
        const est_column *c = &e->column[j];
        const sh_state_variable_filter *f = &e->filter[j];

        switch (c->kind) {
        case LAG:
            x[j] = sh_state_variable_filter_first(f, design);
            break;
        case LOAD:
            x[j] = beside_smooth(f, design);
            break;
        case DELAY:
            x[j] = c->prior * (sh_state_variable_filter_first(&e->torque, design) +
                               e->late / 2 * sh_state_variable_filter_second(&e->torque, design));
            break;
        case REVERSAL:
            x[j] = c->prior * sh_state_variable_filter_first(&e->friction, design);
            break;
        case SIN_M:
        case COS_M:
            x[j] = e->known ? e->sigma * sh_state_variable_filter_output(f) +
                                  sq(s->gamma) * (s->D * sh_state_variable_filter_first(f, design) +
                                                  s->B * sh_state_variable_filter_second(f, design))
                            : 0;
            break;
        case VISCOUS:
            x[j] = -c->prior * viscous;
            break;
        case INERTIA:
            x[j] = -c->prior * inertial;
            break;
        case COULOMB:
            x[j] = -c->prior * sh_fabs(s->gamma) * beside_smooth(&e->friction, design);
            break;
        default:
            x[j] = sh_state_variable_filter_output(f);
        }
    }
    x[e->columns] = torque;
    x[e->columns + 1] = s->measured ? torque : inertial + viscous + torque;
}

/* ---- posterior ---------------------------------------------------------------------------- */

/* Whether the deformation is large enough to distinguish a column from the spring. */
static int is_distinct(const est *e, const est_column *c)
{
    const sh_real range = e->s.range_phi;

    if (c->kind == CLIP)
        return 2 * CLIPS[c->index] * range < e->span;
    if (c->kind == PLAY)
        return 2 * PLAYS[c->index] * range < e->span;
    return 1;
}

/* Columns of a posterior: those always on, the groups that are on, the group on trial last. */
static void choose(const est *e, est_posterior *p, int pair)
{
    int n = 0, j;

    p->pair = pair;
    p->C = p->B = p->D = -1;
    for (j = 0; j < e->columns; ++j) {
        const est_column *c = &e->column[j];
        if (c->group != 0 && (c->group == pair || !e->on[c->group] || !is_distinct(e, c)))
            continue;
        if (c->kind == COULOMB)
            p->C = n;
        if (c->kind == INERTIA)
            p->B = n;
        if (c->kind == VISCOUS)
            p->D = n;
        p->column[n++] = j;
    }
    for (j = 0; j < e->columns && pair != 0; ++j)
        if (e->column[j].group == pair && is_distinct(e, &e->column[j]))
            p->column[n++] = j;
    tri_start(&p->t, n, 1);
    p->surplus = p->taken = p->square = 0;
}

/* Takes a row [size: columns + TRI_SIDES] of the data. */
static void take(est *e, est_posterior *p, const sh_real *x, sh_real w)
{
    sh_real *row = e->work.row;
    int j;

    for (j = 0; j < p->t.n; ++j)
        row[j] = x[p->column[j]];
    for (j = 0; j < TRI_SIDES; ++j)
        row[p->t.n + j] = x[e->columns + j];
    tri_take(&p->t, row, w);
}

/* Removes from the last parameter, b, the information that is only rounding. */
static void take_back(est *e, est_posterior *p)
{
    sh_real back, left, *z;

    if (p->B < 0 || p->B != p->t.n - 1)
        return;
    back = sh_fmin(p->surplus, p->t.D[p->B] - 1);
    if (!(back > 0))
        return;
    left = p->t.D[p->B] - back;
    z = tri_row(&p->t, p->B);
    z[0] *= p->t.D[p->B] / left;
    z[1] = (z[1] * p->t.D[p->B] + back / e->s.prior.B) / left;
    p->t.D[p->B] = left;
    p->surplus -= back;
    p->taken += back;
}

/* Variance of parameter i of a posterior. */
static sh_real variance_of(est *e, est_posterior *p, int i)
{
    sh_real *c = e->work.own, sum = 0;
    int j;

    for (j = 0; j < p->t.n; ++j)
        c[j] = j == i ? 1 : 0;
    tri_project(&p->t, c, e->work.v);
    for (j = i; j < p->t.n; ++j)
        sum += sq(e->work.v[j]) / p->t.D[j];
    return sum;
}

/* Computes estimate and variance. The information about b is reduced meanwhile: a part of it may be
 * rounding, see README.md.
 */
static void evaluate(est *e, est_output *out)
{
    est_posterior *p = &e->live;
    const int n = p->t.n;
    sh_real *v = e->work.v, *own = e->work.own;
    sh_real D_B = 0, z_B = 0, variance = 0, sigma = 0, gain = 0;
    int j;

    if (p->B >= 0) {
        sh_real *z = tri_row(&p->t, p->B);
        D_B = p->t.D[p->B];
        z_B = z[1];
        if (p->taken > 0) {
            const sh_real I = sh_fmax(D_B - 1, 0);
            const sh_real share = I / (I + p->taken + p->square);
            const sh_real variance_b = 1 / (1 + I * share);
            z[1] = z_B * D_B * share * variance_b;
            p->t.D[p->B] = 1 / variance_b;
        }
    }
    for (j = 0; j < n; ++j)
        own[j] = e->work.dF[p->column[j]];
    tri_project(&p->t, own, v);
    for (j = 0; j < n; ++j) {
        const sh_real *z = tri_row(&p->t, j) + n - 1 - j;
        variance += v[j] * v[j] / p->t.D[j];
        sigma += v[j] * z[1];
        gain += v[j] * z[0];
    }
    tri_solve(&p->t, 1, own);
    for (j = 0; j < e->columns; ++j)
        e->beta[j] = 0;
    for (j = 0; j < n; ++j)
        e->beta[p->column[j]] = own[j];
    if (p->B >= 0) {
        p->t.D[p->B] = D_B;
        tri_row(&p->t, p->B)[1] = z_B;
    }
    out->sigma = sigma;
    out->by_gain = gain / sh_fmax(sh_fabs(sigma), (sh_real)1e-20);
    out->sigma_std = sh_sqrt(variance + sq(e->s.prior.torque_gain * gain));
    e->sigma = sigma;
    e->known = sh_sqrt(variance) < KNOWN * sigma;
}

/* Fourth difference of theta: rounding and jitter, with 70 times their variance. */
static sh_real fourth_difference(const est *e)
{
    return e->last[0] - 4 * e->last[1] + 6 * e->last[2] - 4 * e->last[3] + e->last[4];
}

/* ---- misfit ------------------------------------------------------------------------------- */

/* Computes q, how much larger the slow part of the error is than the noise, and from it the factor
 * kappa^2 by which all variances grow.
 */
static void judge(est *e)
{
    const sh_real N = e->blocks, p = (sh_real)e->live.t.n;
    sh_real t, q;

    if (N < FIRST_BLOCKS) {
        e->q = e->kappa2 = 1;
        return;
    }
    q = tri_squares(e->drifts ? &e->walking : &e->block, e->beta) / (N - p / 2);
    t = 1 + 3 * sh_sqrt(2 / N);
    e->q = q;
    if (!(e->s.memory > 0)) { /* switched off */
        e->kappa2 = 1;
        return;
    }
    e->kappa2 = sh_fmax(1, q);
    if (q > t)
        e->kappa2 = sh_fmax(q, 1 + (q - t) * sh_fmax(1, N / 5));
}

/* A block is a mean over 50 ms under the window h = 16 x^2 (1 - x)^2: smooth, so that little of the
 * rounding of theta'' is left in it.
 */
static sh_real window(sh_real k, sh_real length)
{
    const sh_real x = (k + (sh_real)0.5) / length;

    return 16 * sq(x * (1 - x));
}

/* The shares of white noise that pass H and s^2 H and remain in a block: the energies of the
 * filtered window.
 */
static void design_block(est *e)
{
    sh_state_variable_filter f;
    sh_real k;

    e->length = sh_fmax(sh_floor(BLOCK / e->s.T + (sh_real)0.5), 4);
    e->energy[0] = e->energy[1] = 0;
    sh_state_variable_filter_start(&f, 0);
    for (k = 0; k < e->length + 30 / (e->s.bandwidth * e->s.T); ++k) {
        sh_state_variable_filter_step(&f, &e->design, k < e->length ? window(k, e->length) : 0);
        e->energy[0] += sq(sh_state_variable_filter_output(&f));
        e->energy[1] += sq(sh_state_variable_filter_second(&f, &e->design));
    }
    for (k = 0; k < e->length; ++k)
        e->energy[2] += sq(window(k, e->length));
    e->energy[0] /= e->energy[2];
    e->energy[1] /= e->energy[2];
}

static void end_block(est *e)
{
    const est_settings *s = &e->s;
    const int n = e->columns + TRI_SIDES;
    int j;

    if (e->weight > 0) {
        /* Rounding of theta: as if all samples had weighed the same. */
        const sh_real rounding =
            s->measured ? 0 : sq(sq(s->gamma) * s->B) * e->fourth / (sh_real)e->in_block;
        const sh_real share = e->weight2 / sq(e->weight); /* sum h^2 w / (sum h w)^2 */
        const sh_real variance =
            share * e->energy[0] + rounding * e->energy[1] * e->window2 / sq(e->window1);

        for (j = 0; j < n; ++j)
            e->sum[j] /= e->weight;
        for (j = 0; j < n; ++j)
            e->work.row[j] = e->sum[j];
        tri_take(&e->walking, e->work.row, 1 / variance);
        for (j = 0; j < n; ++j)
            e->work.row[j] = e->sum[j];
        tri_take(&e->fresh, e->work.row, 1 / variance);
        e->fresh_blocks += 1;
        tri_take(&e->block, e->sum, 1 / variance);
        e->blocks += 1;
    }
    for (j = 0; j < n; ++j)
        e->sum[j] = 0;
    e->weight = e->weight2 = e->fourth = e->window1 = e->window2 = 0;
    e->in_block = 0;
}

static void add_to_block(est *e, const sh_real *x, sh_real w)
{
    const sh_real h = window((sh_real)e->in_block, e->length), wh = w * h;
    int j;

    for (j = 0; j < e->columns + TRI_SIDES; ++j)
        e->sum[j] += wh * x[j];
    e->weight += wh;
    e->weight2 += wh * h;
    e->window1 += h;
    e->window2 += sq(h);
    e->fourth += sq(fourth_difference(e)) / 70;
    e->in_block += 1;
    if ((sh_real)e->in_block >= e->length)
        end_block(e);
}

/* ---- passes ------------------------------------------------------------------------------- */

static void fade(tri *t, sh_real keep, sh_real least)
{
    int j;

    for (j = 0; j < t->n; ++j)
        t->D[j] = sh_fmax(t->D[j] * keep, least);
    t->rest *= keep;
}

/* Forgets all data, whether they contradict the model or not. If the recent data alone agree with
 * the model, then the older data contradict it, and they are forgotten faster.
 */
static void forget(est *e, sh_real time)
{
    const sh_real N = e->fresh_blocks;
    const int changed = N > FIRST_BLOCKS && e->fresh.rest < N * (1 + 3 * sh_sqrt(2 / N));
    const sh_real keep = sh_exp(-time / (changed ? e->s.memory / 5 : e->s.memory));

    fade(&e->data, keep, TINY);
    fade(&e->block, keep, TINY);
    fade(&e->walking, keep, TINY);
    e->blocks *= keep;
    e->surplus *= keep;
    e->square *= keep;
}

/* Lets parameters walk along v [size: n]: P += c v v' is, for the information A,
 * A -= A v v'A c / (1 + c v'A v), one row with a negative weight. A stays positive.
 */
static void walk(est *e, tri *t, const sh_real *v, sh_real c)
{
    const int n = t->n;
    sh_real *x = e->work.row;
    sh_real vAv = 0;
    int k, j;

    for (j = 0; j < n + TRI_SIDES; ++j)
        x[j] = 0;
    for (k = 0; k < n; ++k) { /* x = v' U' D [U, z] */
        const sh_real *row = tri_row(t, k);
        sh_real u = v[k], Du;

        for (j = k + 1; j < n; ++j)
            u += row[j - k - 1] * v[j];
        Du = t->D[k] * u;
        if (!(sh_fabs(Du) > 0))
            continue;
        x[k] += Du;
        for (j = k + 1; j < n + TRI_SIDES; ++j)
            x[j] += Du * row[j - k - 1];
        vAv += Du * u;
    }
    tri_take(t, x, -c / (1 + c * vAv));
}

/* The curve drifts along the columns of the last sample (units of the prior: P_0 = 1), in
 * proportion to the time, and less if the sample is noisy.
 */
static void drift(est *e, sh_real time)
{
    sh_real *v = e->work.own;
    sh_real power = 0;
    int j;

    for (j = 0; j < e->columns; ++j) {
        const int kind = e->column[j].kind;

        v[j] = kind == BASIS || kind == NOMINAL || kind == POWER || kind == SETPOWER ? e->last_x[j]
                                                                                     : 0;
        power += sq(v[j]);
    }
    if (power > 0) {
        const sh_real c = e->s.drift * time / (power + e->R);

        walk(e, &e->data, v, c);
        walk(e, &e->block, v, c);
        walk(e, &e->walking, v, c);
    }
}

static void walk_friction(est *e, tri *t, sh_real variance)
{
    sh_real *v = e->work.own;
    int j, k;

    for (j = 0; j < e->columns; ++j)
        if (e->column[j].kind == VISCOUS || e->column[j].kind == COULOMB) {
            for (k = 0; k < e->columns; ++k)
                v[k] = k == j ? 1 : 0;
            walk(e, t, v, variance);
        }
}

/* Whether friction drifts: the blocks contradict each other clearly less if it may. */
static void watch_friction(est *e)
{
    const sh_real N = e->blocks, p = (sh_real)e->columns;
    const sh_real still = e->block.rest, drifting = e->walking.rest;

    walk_friction(e, &e->walking, WALK * (sh_real)(4 * e->columns) * e->s.T);
    if (N > 2 * p) {
        if (drifting < (sh_real)0.8 * still && still > (N - p) * (1 + 3 * sh_sqrt(2 / N)))
            e->drifts = 1;
        else if (drifting > (sh_real)0.95 * still)
            e->drifts = 0;
    }
    if (e->drifts)
        walk_friction(e, &e->data, WALK * (sh_real)(4 * e->columns) * e->s.T);
}

static int exists(const est *e, int group)
{
    int j;

    for (j = 0; j < e->columns; ++j)
        if (e->column[j].group == group && is_distinct(e, &e->column[j]))
            return 1;
    return 0;
}

static void start_pass(est *e)
{
    int pair = 0;

    judge(e);
    e->turn = !e->turn;
    if (e->turn == 0 && e->blocks >= FIRST_BLOCKS) {
        int tries;
        for (tries = 0; tries < EST_GROUPS && pair == 0; ++tries) {
            e->next_pair = e->next_pair % (EST_GROUPS - 1) + 1;
            if (exists(e, e->next_pair))
                pair = e->next_pair;
        }
    }
    if (pair == 0) {
        const sh_real time = (sh_real)(4 * e->columns) * e->s.T; /* since the last one */
        const sh_real keep = sh_exp(-10 * time / e->s.memory);

        e->turn = 1;
        fade(&e->fresh, keep, 1);
        e->fresh_blocks *= keep;
        if (e->kappa2 > (sh_real)1.5)
            forget(e, time);
        watch_friction(e);
        if (e->s.drift > 0)
            drift(e, time);
    }
    choose(e, &e->build, pair);
    e->frozen = e->data;
    e->build.weight = pair == 0 ? 1 / e->kappa2 : 1 / sh_fmax(sh_fmax(1, e->q), e->excess_mean);
    e->build.surplus = e->surplus * e->build.weight;
    e->build.square = e->square * sq(e->build.weight);
    e->row = 0;
}

/* Whether the group on trial is to be on: gain of the logarithm of the evidence. */
static void decide(est *e)
{
    est_posterior *p = &e->build;
    sh_real gain = 0;
    int j;

    for (j = 0; j < p->t.n; ++j) {
        const sh_real z = tri_row(&p->t, j)[p->t.n - 1 - j + 1];
        if (e->column[p->column[j]].group == p->pair)
            gain += (p->t.D[j] * z * z - sh_log(p->t.D[j])) / 2;
    }
    if (gain > 3)
        e->on[p->pair] = 1;
    if (gain < 0)
        e->on[p->pair] = 0;
}

static void step_pass(est *e)
{
    sh_real *x = e->work.x;
    const sh_real *row;
    int j;

    if (e->row >= e->columns) {
        if (e->build.pair != 0) {
            decide(e);
        } else {
            e->live = e->build;
            take_back(e, &e->live);
        }
        start_pass(e);
        return;
    }
    row = tri_row(&e->frozen, e->row);
    for (j = 0; j < e->row; ++j)
        x[j] = 0;
    x[e->row] = 1;
    for (j = e->row + 1; j < e->columns + TRI_SIDES; ++j)
        x[j] = row[j - e->row - 1];
    if (e->frozen.D[e->row] > 0)
        take(e, &e->build, x, e->frozen.D[e->row] * e->build.weight);
    e->row += 1;
}

/* ---- samples ------------------------------------------------------------------------------ */

void est_start(est *e, const est_settings *s)
{
    memset(e, 0, sizeof *e);
    e->s = *s;
    if (!s->measured && s->count > 0) /* somewhat above the frequency where both noises are equal */
        e->s.bandwidth =
            sh_fmin(s->bandwidth,
                    (sh_real)1.42 *
                        sh_sqrt(s->noise / (s->B * sh_fabs(s->gamma) * s->count) * sh_sqrt(12)));
    e->design = sh_state_variable_filter_design(e->s.bandwidth, s->T);
    e->rounding = sh_state_variable_filter_noise(&e->design);
    e->starting = FORGOTTEN / e->s.bandwidth;
    design_block(e);
    make_columns(e);
    tri_start(&e->data, e->columns, TINY);
    tri_start(&e->block, e->columns, TINY);
    tri_start(&e->walking, e->columns, TINY);
    tri_start(&e->fresh, e->columns, 1);
    choose(e, &e->live, 0);
    e->live.weight = 1;
    e->q = e->kappa2 = e->excess = e->excess_mean = 1;
    start_pass(e);
}

static sh_real white(const est_settings *s)
{
    return (sh_real)(3.0 / 16) * s->bandwidth * s->T;
}

static sh_real friction_variance(est *e)
{
    const int C = e->live.C;
    const sh_real unknown = sh_state_variable_filter_output(&e->unknown);
    sh_real tau_C;

    if (C < 0 || !(sh_fabs(unknown) > 0))
        return 0;
    tau_C = sq(e->beta[e->live.column[C]]) + variance_of(e, &e->live, C);
    return sq(e->s.gamma * e->s.prior.tau_coulomb) * tau_C * sq(unknown);
}

static sh_real noise_variance(est *e)
{
    const est_settings *s = &e->s;
    const sh_real rounding = sq(e->sigma) * (sq(s->count) + sq(s->count_q)) / 12;
    sh_real R = rounding + sq(s->noise), stays = rounding * e->resting;

    if (!s->measured) {
        const sh_real friction = friction_variance(e);
        R = (rounding + sq(s->gamma * s->noise)) * (1 + EXCESS * (e->excess - 1)) +
            friction / white(s);
        stays += friction * e->unsure;
    }
    return R * sq(1 + stays / R);
}

/* Computes how much larger the filtered noise is than if theta were only rounded. Jitter makes it
 * so.
 */
static void watch_noise(est *e)
{
    const est_settings *s = &e->s;
    const sh_real share = e->s.T / (sh_real)0.1;
    const sh_real inertia = sq(sq(s->gamma) * s->B) * e->rounding;
    const sh_real known = white(s) * sq(s->gamma * s->noise) + inertia * sq(s->count) / 12;

    e->rough += share * (sq(fourth_difference(e)) / 70 - e->rough);
    e->excess = sh_fmax(1, (white(s) * sq(s->gamma * s->noise) + inertia * e->rough) / known);
    e->excess_mean += e->s.T / 5 * (e->excess - e->excess_mean);
}

static int was_moving(est *e, const sh_real *x)
{
    const est_settings *s = &e->s;
    const sh_real inertial = sq(s->gamma) * s->B * s->count;
    sh_real variance =
        white(s) * sq(s->gamma * s->noise) + sq(inertial) / 12 * e->rounding + friction_variance(e);
    sh_real epsilon = x[e->columns + 1];
    int j;

    for (j = 0; j < e->live.t.n; ++j) {
        e->work.own[j] = x[e->live.column[j]];
        epsilon -= e->work.own[j] * e->beta[e->live.column[j]];
    }
    tri_project(&e->live.t, e->work.own, e->work.v);
    for (j = 0; j < e->live.t.n; ++j)
        variance += sq(e->work.v[j]) / e->live.t.D[j];
    return sq(epsilon) > 25 * variance;
}

/* Counts how much of the information about b is rounding and jitter of theta''. */
static void compensate(est *e, sh_real R)
{
    const est_settings *s = &e->s;
    const sh_real V = sq(sq(s->gamma) * s->B * fourth_difference(e)) / 70 * e->rounding;
    const sh_real N = V / R * sq(s->prior.B), w = e->live.weight;

    if (e->live.B < 0)
        return;
    e->surplus += N;
    e->square += 6 * sq(N);
    e->live.surplus += N * w;
    e->live.square += 6 * sq(N * w);
    e->build.surplus += N * e->build.weight;
    e->build.square += 6 * sq(N * e->build.weight);
    take_back(e, &e->live);
}

static void learn(est *e, const sh_real *x)
{
    sh_real *copy = e->work.row;
    sh_real R, w;
    int j;

    watch_noise(e);
    R = noise_variance(e);
    w = 1 / R;
    e->R = R;
    for (j = 0; j < e->columns; ++j)
        e->last_x[j] = x[j];

    for (j = 0; j < e->columns + TRI_SIDES; ++j)
        copy[j] = x[j];
    tri_take(&e->data, copy, w);
    take(e, &e->live, x, w * e->live.weight);
    take(e, &e->build, x, w * e->build.weight);
    if (!e->s.measured)
        compensate(e, R);
    add_to_block(e, x, w);
    e->wait = !e->wait;
    if (!e->wait)
        step_pass(e);
}

static sh_real value(const est *e, int kind)
{
    const int j = e->place[kind];

    return j < 0 ? 0 : e->beta[j] * e->column[j].prior;
}

/* Decides whether the estimate is confident, and if not, why. */
static void doubt(est *e, est_output *out, sh_real phi)
{
    const est_settings *s = &e->s;
    const sh_real claim = out->sigma_std / sh_fmax(sh_fabs(out->sigma), (sh_real)1e-20);

    out->doubt = EST_NONE;
    if (!(claim < s->confidence))
        out->doubt = e->kappa2 > (sh_real)1.5 ? EST_MISFIT : EST_NOT_EXCITED;
    if (sh_fabs(phi) > 2 * s->range_phi)
        out->doubt = EST_OUT_OF_RANGE;
    if (s->prior.D > 0 && sh_fabs(out->d) > 3 * s->prior.D)
        out->doubt = EST_FRICTION_OUTSIDE;
    if (s->prior.B > 0 && sh_fabs(out->b) > 3 * s->prior.B)
        out->doubt = EST_INERTIA_OUTSIDE;
    if (!(out->sigma > 0))
        out->doubt = EST_NEGATIVE;
    out->confident = out->doubt == EST_NONE;
    out->claim = claim;
}

void est_tick(est *e, sh_real theta, sh_real q, sh_real set_point, sh_real torque, est_output *out)
{
    const est_settings *s = &e->s;
    const sh_real phi = q - theta, change = phi - e->phi;
    sh_real *x = e->work.x;

    memset(out, 0, sizeof *out);
    if (e->begun)
        move_plays(e, change);
    else
        e->least = e->most = phi;
    watch_span(e, phi);
    make_inputs(e, theta, q, phi, set_point);
    if (!e->begun)
        begin_filters(e, theta, torque);
    else
        filter(e, theta, torque);
    e->resting = sh_fabs(change) > sh_fmin(s->count, s->count_q) / 4 ? 0 : e->resting + 1;
    e->phi = phi;
    e->begun = 1;
    regression(e, x);
    e->y = x[e->columns + 1];
    e->settling -= s->T;
    if (!(e->settling > 0)) {
        e->settling = 0;
        if (!s->measured && e->starting > 0) {
            e->starting -= s->T;
            if (was_moving(e, x)) {
                e->settling = FORGOTTEN / s->bandwidth;
                e->starting = 0;
            }
        }
        if (!(e->settling > 0))
            learn(e, x);
    }
    evaluate(e, out);
    out->tau_e = curve(e);
    out->misfit = sh_sqrt(sh_fmax(1, e->q));
    out->d = value(e, VISCOUS);
    out->b = value(e, INERTIA);
    out->tau_coulomb = value(e, COULOMB);
    out->bias = value(e, BIAS);
    out->lag = value(e, LAG) / (s->prior.tau_e / s->range_phi);
    out->load_friction = value(e, LOAD);
    out->delay = value(e, DELAY) / sh_fabs(s->gamma);
    e->late = clamp(out->delay, 3 * s->prior.delay);
    out->active = e->live.t.n;
    {
        int g;
        for (g = 1; g < EST_GROUPS; ++g)
            out->on |= e->on[g] ? 1 << g : 0;
    }
    doubt(e, out, phi);
}

/* The estimate at another operating point. Nothing is learned. */
void est_ask(est *e, sh_real phi, sh_real set_point, est_output *out)
{
    const sh_real sigma = e->sigma;
    const int known = e->known;

    memset(out, 0, sizeof *out);
    make_inputs(e, 0, phi, phi, set_point);
    evaluate(e, out);
    out->tau_e = curve(e);
    e->sigma = sigma;
    e->known = known;
}
