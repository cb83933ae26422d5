#include "posterior.h"

#include <string.h>

#include "columns.h"
#include "information.h"
#include "real_math.h"

/* Relative error of the removed information. Rounding depends on the motion, and repeats with it. */
static const sh_real REMOVAL_ERROR = (sh_real)0.05;

/* Whether a column is used, and not one of the trial. */
static int is_used(const sh_regression_state *state, const sh_parameters *p,
                   const sh_column *column, int trial)
{
    const int group = sh_column_group(column);

    return group == 0 ||
           (group != trial && state->used[group] && sh_column_can_join(state, p, column, group));
}

void sh_posterior_start(const sh_regression_state *state, const sh_parameters *p,
                        sh_posterior *posterior, int trial, sh_real weight)
{
    int size = 0, i;

    posterior->coulomb = posterior->inertia = -1;
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < state->size; ++i) {
        const sh_column *column = &state->column[i];

        if (!is_used(state, p, column, trial)) {
            continue;
        }
        if (column->kind == SH_COLUMN_COULOMB) {
            posterior->coulomb = size;
        }
        if (column->kind == SH_COLUMN_INERTIA) {
            posterior->inertia = size;
        }
        posterior->column[size++] = i;
    }
    for (i = 0; i < state->size && size < state->size && trial != 0; ++i) {
        if (sh_column_can_join(state, p, &state->column[i], trial)) {
            posterior->column[size++] = i;
        }
    }
    sh_information_start(&posterior->information, size, 1);
    posterior->weight = weight;
    posterior->surplus = posterior->removed = posterior->spread = 0;
}

void sh_posterior_copy(sh_posterior *to, const sh_posterior *from)
{
    int i;

    sh_information_copy(&to->information, &from->information);
    for (i = 0; i < from->information.size; ++i) {
        to->column[i] = from->column[i];
    }
    to->coulomb = from->coulomb;
    to->inertia = from->inertia;
    to->weight = from->weight;
    to->surplus = from->surplus;
    to->removed = from->removed;
    to->spread = from->spread;
}

sh_real sh_posterior_take(const sh_regression_state *state, sh_posterior *posterior,
                          const sh_real *x, sh_real w, sh_real *row)
{
    const int size = posterior->information.size;
    const sh_real weight = w * posterior->weight;
    int i;

    for (i = 0; i < size; ++i) {
        row[i] = x[posterior->column[i]];
    }
    for (i = 0; i < SH_SIDES; ++i) {
        row[size + i] = x[state->size + i];
    }
    return sh_information_take(&posterior->information, row, weight) / weight;
}

void sh_posterior_remove(sh_posterior *posterior, sh_real information, sh_real prior_B)
{
    const int b = posterior->inertia;
    sh_real *D = posterior->information.D;
    sh_real back, left, *z;

    posterior->surplus += information;
    if (b < 0 || b != posterior->information.size - 1) {
        return;
    }
    back = sh_fmin(posterior->surplus, D[b] - 1); /* 1: the prior */
    if (!(back > 0)) {
        return;
    }
    left = sh_fmax(D[b] - back, 1); /* D[b] - 1 is rounded where D[b] is larger than 1 / epsilon */
    z = sh_information_last(&posterior->information);
    z[SH_SIDE_GAIN] *= D[b] / left;
    z[SH_SIDE_Y] = (z[SH_SIDE_Y] * D[b] + back / prior_B) / left; /* biased towards b = -1 */
    D[b] = left;
    posterior->surplus -= back;
    posterior->removed += back;
}

/* Gives the data about b, the last one, the weight that they have after the removal: D[b], and both sides z. */
static void weigh_inertia(sh_posterior *posterior, int b, sh_real prior_B)
{
    sh_real *const D = &posterior->information.D[b];
    sh_real *const z = sh_information_last(&posterior->information);
    const sh_real of_data = sh_fmax(*D - 1, 0);
    const sh_real unsure = REMOVAL_ERROR / prior_B * posterior->removed;
    const sh_real share =
        of_data / (of_data + posterior->removed + posterior->spread + unsure * unsure);
    const sh_real weighted = 1 + of_data * share;

    z[SH_SIDE_GAIN] *= *D * share / weighted;
    z[SH_SIDE_Y] *= *D * share / weighted;
    *D = weighted;
}

/* v^2 / D, also where v^2 overflows: in single precision D can be as large. */
static sh_real square_over(sh_real v, sh_real D)
{
    const sh_real square = v * v;

    return square <= SH_LARGEST_OUTPUT ? square / D : v / D * v;
}

sh_stiffness_fit sh_posterior_evaluate(sh_regression_state *state, sh_posterior *posterior)
{
    sh_information *a = &posterior->information;
    const int size = a->size, b = posterior->inertia;
    sh_real *const own = state->work.own, *const v = state->work.v;
    sh_real D_b = 0, z_b[SH_SIDES] = {0, 0};
    sh_stiffness_fit fit = {0, 0};
    int i;

    if (b >= 0 && posterior->removed > 0) {
        D_b = a->D[b];
        (void)memcpy(z_b, sh_information_last(a), sizeof z_b);
        weigh_inertia(posterior, b, state->column[posterior->column[b]].prior);
    }
    for (i = 0; i < size; ++i) {
        own[i] = state->work.dF[posterior->column[i]];
    }
    fit.variance = sh_posterior_variance(posterior, own, v);
    sh_information_side(a, SH_SIDE_GAIN, own);
    for (i = 0; i < size; ++i) {
        fit.by_gain += v[i] * own[i];
    }
    sh_information_solve(a, SH_SIDE_Y, own);
    for (i = 0; i < state->size; ++i) {
        state->beta[i] = 0;
    }
    for (i = 0; i < size; ++i) {
        state->beta[posterior->column[i]] = own[i];
    }
    if (b >= 0 && posterior->removed > 0) {
        a->D[b] = D_b;
        (void)memcpy(sh_information_last(a), z_b, sizeof z_b);
    }
    return fit;
}

sh_real sh_posterior_variance(const sh_posterior *posterior, const sh_real *c, sh_real *v)
{
    const sh_information *a = &posterior->information;
    sh_real variance = 0;
    int i;

    sh_information_project(a, c, v);
    for (i = 0; i < a->size; ++i) {
        variance += square_over(v[i], a->D[i]);
    }
    return variance;
}
