#include "forgetting.h"

#include "blocks.h"
#include "columns.h"
#include "information.h"
#include "real_math.h"

/* Variance by which friction may change in a second, in units of its prior's [1/s]. */
static const sh_real WALK = (sh_real)1e-3;

static void fade_recent(sh_blocks *blocks, const sh_parameters *p, sh_real time)
{
    const sh_real keep = p->regression.memory > 0 ? sh_exp(-10 * time / p->regression.memory) : 1;

    sh_information_fade(&blocks->recent, keep, 1);
    blocks->recent_count *= keep;
}

static void forget(sh_regression_state *state, const sh_parameters *p, sh_real time)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->recent_count;
    const int has_changed = N > SH_BLOCKS_FIRST && blocks->recent.rest < sh_blocks_threshold(N);
    const sh_real memory = has_changed ? p->regression.memory / 5 : p->regression.memory;
    const sh_real keep = sh_exp(-time / memory);

    sh_information_fade(&state->data, keep, SH_INFORMATION_LEAST);
    sh_blocks_fade(blocks, keep);
    state->surplus *= keep;
    state->spread *= keep * keep;
    state->rounding *= keep;
}

static void walk_friction(sh_regression_state *state, sh_information *a, sh_real variance)
{
    sh_real *const v = state->work.own;
    int i, k;

    for (i = 0; i < state->size; ++i) {
        const int kind = state->column[i].kind;

        if (kind != SH_COLUMN_VISCOUS && kind != SH_COLUMN_COULOMB) {
            continue;
        }
        for (k = 0; k < state->size; ++k) {
            v[k] = k == i ? 1 : 0;
        }
        sh_information_walk(a, v, variance, state->work.row);
    }
}

void sh_forgetting_of_friction(sh_regression_state *state, sh_real time)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->count, parameters = (sh_real)state->size;

    walk_friction(state, &blocks->walking, WALK * time);
    if (N > 2 * parameters) {
        const sh_real constant = blocks->all.rest, walking = blocks->walking.rest;
        const sh_real limit = (N - parameters) * sh_blocks_threshold(N) / N;

        if (walking < (sh_real)0.8 * constant && constant > limit) {
            state->friction_drifts = 1;
        } else if (walking > (sh_real)0.95 * constant) {
            state->friction_drifts = 0;
        }
    }
    if (state->friction_drifts) {
        walk_friction(state, &state->data, WALK * time);
    }
}

/* Whether a column belongs to the smooth curve of the torque. */
static int is_curve(const sh_column *column)
{
    return sh_column_is_torque(column) && !sh_column_is_gap(column);
}

static void drift(sh_regression_state *state, const sh_parameters *p, const sh_real *x,
                  sh_real time)
{
    sh_real *const v = state->work.own;
    sh_real power = 0, variance;
    int i;

    for (i = 0; i < state->size; ++i) {
        v[i] = is_curve(&state->column[i]) ? x[i] : 0;
        power += v[i] * v[i];
    }
    if (!(power > 0)) {
        return;
    }
    variance = p->regression.drift * time / (power + state->R);
    sh_information_walk(&state->data, v, variance, state->work.row);
    sh_information_walk(&state->blocks.all, v, variance, state->work.row);
    sh_information_walk(&state->blocks.walking, v, variance, state->work.row);
}

void sh_forgetting_step(sh_regression_state *state, const sh_parameters *p, const sh_real *x,
                        sh_real time)
{
    const sh_real gained = state->blocks.gained;

    state->blocks.gained = 0;
    fade_recent(&state->blocks, p, gained);
    if (state->variance_factor > SH_CONTRADICTION) {
        forget(state, p, gained);
    }
    if (p->regression.drift > 0) {
        drift(state, p, x, time);
    }
}
