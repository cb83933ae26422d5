#include "passes.h"

#include "blocks.h"
#include "columns.h"
#include "forgetting.h"
#include "information.h"
#include "posterior.h"
#include "real_math.h"

/* Gain of the evidence above which a group is used: of the first blocks, and in addition of each
 * one. Rounding of a periodic motion repeats, and is evidence for any column, but a small one. What
 * is worth a column reduces the variance of the error by a tenth.
 */
static const sh_real FIRST_GAIN = 3, GAIN_PER_BLOCK = (sh_real)0.05;

/* Whether a group has a column that can be told from the spring. */
static int has_columns(const sh_regression_state *state, const sh_parameters *p, int group)
{
    int i;

    for (i = 0; i < state->size; ++i) {
        if (sh_column_can_join(state, p, &state->column[i], group)) {
            return 1;
        }
    }
    return 0;
}

/* The next group that can be tried, 0 if there is none. */
static int next_trial(sh_regression_state *state, const sh_parameters *p)
{
    int tries;

    for (tries = 1; tries < SH_GROUPS; ++tries) {
        state->last_trial = state->last_trial % (SH_GROUPS - 1) + 1;
        if (has_columns(state, p, state->last_trial)) {
            return state->last_trial;
        }
    }
    return 0;
}

static void start_pass(sh_regression_state *state, const sh_parameters *p)
{
    sh_posterior *build = &state->build;
    /* Noise that is correlated is no evidence for columns. */
    const sh_real weight = state->trial == 0
                               ? 1 / state->variance_factor
                               : 1 / sh_fmax(sh_fmax(1, state->q), state->history.excess_mean);

    sh_posterior_start(state, p, build, state->trial, weight);
    build->surplus = state->surplus * weight;
    build->spread = state->spread * weight * weight;
    sh_information_copy(&state->frozen, &state->data);
    state->row = 0;
}

/* Chooses what the next pass is: a trial after every one that changes the estimate. */
static void plan(sh_regression_state *state, const sh_parameters *p)
{
    const int was_trial = state->trial != 0;

    sh_blocks_judge(state, p);
    state->trial = 0;
    if (!was_trial && state->blocks.count >= SH_BLOCKS_FIRST) {
        state->trial = next_trial(state, p);
    }
}

void sh_passes_start(sh_regression_state *state, const sh_parameters *p)
{
    state->variance_factor = state->q = 1;
    start_pass(state, p);
}

static void decide(sh_regression_state *state)
{
    sh_posterior *build = &state->build;
    const sh_information *a = &build->information;
    sh_real *const z = state->work.own;
    sh_real gain = 0;
    int i;

    sh_information_side(a, SH_SIDE_Y, z);
    for (i = 0; i < a->size; ++i) {
        if (sh_column_group(&state->column[build->column[i]]) == state->trial) {
            gain += (a->D[i] * z[i] * z[i] - sh_log(a->D[i])) / 2;
        }
    }
    if (gain > FIRST_GAIN + GAIN_PER_BLOCK * state->blocks.count) {
        state->used[state->trial] = 1;
    }
    if (gain < GAIN_PER_BLOCK / 2 * state->blocks.count) {
        state->used[state->trial] = 0;
    }
}

static void end_pass(sh_regression_state *state, const sh_parameters *p)
{
    if (state->trial != 0) {
        decide(state);
        return;
    }
    sh_posterior_copy(&state->live, &state->build);
    if (state->live.inertia >= 0) {
        sh_posterior_remove(&state->live, 0, p->prior.B);
    }
}

/* Takes the next row of the copy of the data. */
static void take_row(sh_regression_state *state, sh_real *x)
{
    const sh_real w = sh_information_sample(&state->frozen, state->row, x);

    (void)sh_posterior_take(state, &state->build, x, w, state->work.row);
    state->row += 1;
}

/* Time since the data were last treated [s]. */
static sh_real time_since(const sh_regression_state *state)
{
    return state->since * state->design.T;
}

void sh_passes_step(sh_regression_state *state, const sh_parameters *p, sh_real *x, sh_real w)
{
    state->since += 1;
    (void)sh_posterior_take(state, &state->build, x, w, state->work.row);
    state->alternate = !state->alternate;
    if (state->alternate) {
        return;
    }
    /* What a pass needs besides the rows is spread over ticks, too. */
    if (state->row < state->size) {
        take_row(state, x);
        return;
    }
    switch (state->row - state->size) {
    case 0:
        end_pass(state, p);
        plan(state, p);
        break;
    case 1:
        if (state->trial == 0) {
            sh_forgetting_of_friction(state, time_since(state));
        }
        break;
    case 2:
        if (state->trial == 0) {
            sh_forgetting_step(state, p, x, time_since(state));
            state->since = 0;
        }
        break;
    default:
        start_pass(state, p);
        return;
    }
    state->row += 1;
}
