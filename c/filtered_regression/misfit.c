/* Misfit (point 7): prediction errors of blocks of samples that no column explains, and forgetting of such data. */
#include <string.h>

#include "constants.h"
#include "regression.h"
#include "state_variable_filter.h"

/* ---- blocks, detail 8 -------------------------------------------------------------------- */

void sh_blocks_start(sh_regression_state *state)
{
    sh_blocks *blocks = &state->blocks;
    const sh_filter_design *design = &state->signals.design;
    const int K = state->signals.decimation;

    sh_information_start(&blocks->constant, state->columns.size, 1);
    sh_information_start(&blocks->drifting, state->columns.size, 1);
    sh_information_start(&blocks->recent, state->columns.size, 1);
    blocks->prior = 1;
    blocks->length = sh_floor(SH_BLOCK / ((sh_real)K * design->T) + (sh_real)0.5);
    blocks->length = sh_fmin(sh_fmax(blocks->length, SH_SHORTEST_BLOCK), SH_LONGEST_BLOCK);
    sh_state_variable_filter_noise(design, blocks->length, K, &blocks->energy,
                                   &blocks->energy_second);
}

void sh_blocks_interrupt(sh_blocks *blocks)
{
    int i;

    for (i = 0; i < SH_MAX_ROW; ++i) {
        blocks->sum[i] = 0;
    }
    blocks->rows = blocks->weight = blocks->weight_window = 0;
    blocks->window = blocks->window_square = blocks->independent = blocks->rounding = 0;
}

static void forget_blocks(sh_blocks *blocks, sh_real factor)
{
    sh_information_forget(&blocks->constant, factor, SH_LEAST_INFORMATION);
    sh_information_forget(&blocks->drifting, factor, SH_LEAST_INFORMATION);
    blocks->prior *= factor;
    blocks->count *= factor;
}

/* Returns the variance of the mean row of a block. White noise has the variance sum h^2 w / (sum h w)^2 times the share
 * that H leaves. The rounding of theta adds the variance of (gamma^2 B theta'')_f.
 */
static sh_real variance_of(const sh_regression_state *state, const sh_parameters *p)
{
    const sh_blocks *blocks = &state->blocks;
    const sh_real inertia = sh_is_measured(p) ? 0 : sh_square(p->motor.gamma) * p->motor.B;
    const sh_real rounding = sh_square(inertia) * blocks->rounding / blocks->rows;

    return blocks->weight_window / sh_square(blocks->weight) * blocks->energy +
           rounding * blocks->energy_second * blocks->window_square /
               (sh_square(blocks->window) * (sh_real)state->signals.decimation);
}

static void count_block(sh_regression_state *state)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real count = blocks->independent / blocks->window_square;
    const sh_real samples = blocks->length * (sh_real)state->signals.decimation;

    blocks->count += count;
    blocks->recent_count += count;
    blocks->duration += count * samples * state->signals.design.T;
    if (blocks->count > SH_MOST_BLOCKS) {
        forget_blocks(blocks, SH_MOST_BLOCKS / blocks->count);
    }
}

/* Takes or only predicts the mean row of a block [size: SH_MAX_ROW]. Returns the squared error / its variance [1]. */
static sh_real take_block(sh_information *a, const sh_real *mean, sh_real w, int only_predicts)
{
    sh_real x[SH_MAX_ROW], error;

    (void)memcpy(x, mean, sizeof x);
    error = only_predicts ? sh_information_predict(a, x, w) : sh_information_take(a, x, w);
    return sh_limited(error * sh_square(x[a->size + SH_RIGHT_Y]), SH_LARGE);
}

/* The mean row of a block is sum h w x / sum h w. The hypothesis of a change takes the mean row first, because the
 * hypothesis may begin anew before this block. The hypothesis does not take its first block. If the first block is
 * evidence, the spring changes in this block; otherwise, the hypothesis begins anew after the block.
 */
void sh_blocks_end(sh_regression_state *state, const sh_parameters *p, int step)
{
    sh_blocks *blocks = &state->blocks;
    const int count = state->columns.size + SH_RIGHT_SIDES;
    sh_change *change = &state->change;
    sh_real mean[SH_MAX_ROW] = {0}, variance, w, error;
    int i;

    if (!sh_block_is_full(blocks)) {
        return;
    }
    variance = variance_of(state, p);
    for (i = 0; i < count; ++i) {
        mean[i] = blocks->sum[i] / blocks->weight;
    }
    if (!(variance > 0 && sh_sum_of_products(mean, mean, count) / variance <= SH_LARGE)) {
        sh_blocks_interrupt(blocks); /* also if not a number */
        return;
    }
    w = 1 / variance;
    if (step == 0) {
        error = take_block(&change->changed, mean, w, !(change->blocks > 0));
        change->error = sh_change_begins_anew(state, error) ? 0 : error;
    } else if (step == 1) {
        blocks->error = take_block(&blocks->constant, mean, w, 0);
    } else if (step == 2) {
        error = change->friction_error = take_block(&blocks->drifting, mean, w, 0);
        blocks->error = state->friction_drifts ? error : blocks->error;
    } else {
        (void)take_block(&blocks->recent, mean, w, 0);
        count_block(state);
        sh_change_judge(state, p, blocks->error, change->error, change->friction_error);
        sh_blocks_interrupt(blocks);
    }
}

void sh_blocks_take(sh_regression_state *state)
{
    sh_blocks *blocks = &state->blocks;
    const sh_row *row = &state->row;
    const sh_real h = sh_window(blocks->rows, blocks->length), wh = row->w * h;
    int i;

    for (i = 0; i < state->columns.size + SH_RIGHT_SIDES; ++i) {
        blocks->sum[i] += wh * row->x[i];
    }
    blocks->weight += wh;
    blocks->weight_window += wh * h;
    blocks->window += h;
    blocks->window_square += sh_square(h);
    blocks->independent +=
        sh_square(h) / row->lasting; /* rows with the same error count as fewer */
    blocks->rounding += row->rough;
    blocks->rows += 1;
}

/* ---- the variance factor, detail 8 ------------------------------------------------------- */

/* Returns the largest sum of N squared errors that may be due to chance: N t, t = 1 + 3 sqrt(2 / N) */
static sh_real chance(sh_real N)
{
    return N + SH_CHANCE * sh_sqrt(2 * N);
}

/* Returns the sum of the squared errors of the blocks, divided by their variances, with coefficients beta. The matrix
 * of the blocks also contains the share `prior` of the prior, 0..1, which is subtracted.
 */
static sh_real squares_of(const sh_information *blocks, const sh_real *beta, sh_real prior)
{
    return sh_information_squares(blocks, beta) -
           prior * sh_sum_of_products(beta, beta, blocks->size);
}

/* Sets recent_misfit. While friction or the curve drifts, recent_misfit is 0, because the recent blocks do not contain
 * this drift. The prior is subtracted completely, although forgetting reduces the prior. This error is small, because
 * beta' beta is small compared with the squares of 20 blocks.
 */
void sh_misfit_judge_recent(sh_regression_state *state, const sh_parameters *p)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->recent_count;

    blocks->recent_misfit = 0;
    if (N >= SH_FIRST_BLOCKS && !state->friction_drifts && !(p->regression.drift > 0)) {
        const sh_real squares = squares_of(&blocks->recent, state->beta, 1);

        blocks->recent_misfit = squares > chance(N) ? squares / N : 0;
    }
}

/* Returns 1 if there are enough blocks to forget data, and to subtract half the number of parameters in q. */
static int has_many_blocks(const sh_regression_state *state)
{
    const sh_real N = state->blocks.count;

    return N >= SH_FIRST_BLOCKS && N > (sh_real)state->posterior.information.size;
}

/* q = (sum of the squares of the errors of N blocks over their variances) / (N - p / 2), p parameters,
 *
 *     kappa^2 = max(q, q_recent, 1 + (q - t) max(1, N / 5))  if q > t, else max(1, q, q_recent) .
 *
 * A misfit is a function of the state and repeats with the motion, so the part q - t does not average out over N
 * blocks. With few blocks, q is the sum divided by N. With fewer than SH_FEW_BLOCKS blocks, nothing is computed.
 */
void sh_misfit_judge(sh_regression_state *state, const sh_parameters *p)
{
    const sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->count, parameters = (sh_real)state->posterior.information.size;
    sh_real q, t;

    if (!(N >= SH_FEW_BLOCKS)) {
        return;
    }
    q = squares_of(state->friction_drifts ? &blocks->drifting : &blocks->constant, state->beta,
                   blocks->prior) /
        (has_many_blocks(state) ? N - parameters / 2 : N);
    t = chance(N) / N;
    state->misfit = sh_fmax(1, sh_fmax(q, blocks->recent_misfit));
    state->variance_factor = 1;
    if (!(p->regression.memory > 0)) { /* switched off */
        return;
    }
    state->variance_factor = state->misfit;
    if (q > t) {
        state->variance_factor =
            sh_fmax(state->variance_factor, 1 + (q - t) * sh_fmax(1, N / SH_REPEATS));
    }
}

/* ---- drift of friction, detail 10 -------------------------------------------------------- */

/* Decides by the residuals of both regressions whether friction drifts, except during a test of other friction. */
static void judge_drift(sh_regression_state *state)
{
    const sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->count, parameters = (sh_real)state->columns.size;
    const sh_real constant = blocks->constant.squares, drifting = blocks->drifting.squares;

    if (!(N > 2 * parameters) || state->change.friction_blocks > 0) {
        return;
    }
    if (drifting < SH_DRIFT_BEGINS * constant && constant > (N - parameters) * chance(N) / N) {
        state->friction_drifts = 1;
    } else if (drifting > SH_DRIFT_ENDS * constant) {
        state->friction_drifts = 0;
    }
}

void sh_drift_step(sh_refit *refit, sh_information *a, int column, sh_real variance, int step)
{
    if (step % 2 == 0) {
        refit->w = sh_information_drift_sample(a, column, variance, refit->x);
    } else {
        if (refit->w < 0) {
            (void)sh_information_take(a, refit->x, refit->w);
        }
        refit->w = 0;
    }
}

void sh_friction_drift(sh_regression_state *state, sh_real time, int step)
{
    const int kind = step % 4 < 2 ? SH_COLUMN_VISCOUS : SH_COLUMN_COULOMB;
    const int column = sh_columns_place(&state->columns, kind);
    const sh_real variance = SH_FRICTION_DRIFT * time;

    if (column >= 0 && step < 4) {
        sh_drift_step(&state->refit, &state->blocks.drifting, column, variance, step);
    } else if (column >= 0 && state->friction_drifts) {
        sh_drift_step(&state->refit, &state->data, column, variance, step);
    }
    if (step == 3) {
        judge_drift(state);
    }
}

/* ---- forgetting, details 9 and 11 -------------------------------------------------------- */

/* Forgets data, for a motion of the duration `moving` [s]. Data are forgotten faster while the misfit is more than
 * three times the usual misfit, but not faster than the recent blocks. If the recent blocks do not contradict each
 * other, the joint has changed. In this case, data are forgotten at least five times as fast.
 */
static void forget_data(sh_regression_state *state, const sh_parameters *p, sh_real moving)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->recent_count;
    const int has_changed = N > SH_FIRST_BLOCKS && blocks->recent.squares < chance(N);
    const sh_real sudden = sh_fmin(sh_change_misfit(state) / SH_FAR_FROM_USUAL, SH_RECENT);
    const sh_real faster = sh_fmax(sudden, has_changed ? SH_FASTER : 1);
    const sh_real memory = p->regression.memory / faster;
    const sh_real factor = sh_exp(-moving / memory);

    sh_information_forget(&state->data, factor, SH_LEAST_INFORMATION);
    forget_blocks(blocks, factor);
    state->surplus *= factor;
    state->spread *= factor * factor;
    state->weights *= factor;
    state->noise.information *= factor;
    state->noise.gain *= factor;
}

/* P += drift time / (v'v + R) v v'. The vector v contains the columns of the curve in the last row, and R is the
 * variance of this row. The drift reduces the information along v and the sum `weights` by the same factor.
 */
static void let_curve_drift(sh_regression_state *state, const sh_parameters *p, sh_real time)
{
    sh_real v[SH_MAX_COLUMNS] = {0}, power = 0;
    int i;

    for (i = 0; i < state->columns.size; ++i) {
        v[i] = sh_column_is(&state->columns.column[i], SH_IS_CURVE) ? state->row.x[i] : 0;
        power += v[i] * v[i];
    }
    if (power > 0) {
        const sh_real variance = p->regression.drift * time / (power + 1 / state->row.w);

        state->weights *= sh_information_drift(&state->data, v, variance);
        (void)sh_information_drift(&state->blocks.constant, v, variance);
        (void)sh_information_drift(&state->blocks.drifting, v, variance);
    }
}

/* The time of forgetting is the duration of the blocks, so no data are forgotten at rest or with few blocks. */
void sh_forget(sh_regression_state *state, const sh_parameters *p, sh_real time)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real moving = blocks->duration;

    blocks->duration = 0;
    if (p->regression.memory > 0) {
        const sh_real factor = sh_exp(-SH_RECENT * moving / p->regression.memory);

        sh_information_forget(&blocks->recent, factor, 1);
        blocks->recent_count *= factor;
    }
    if (state->variance_factor > SH_CONTRADICTION && has_many_blocks(state)) {
        forget_data(state, p, moving);
    }
    if (p->regression.drift > 0) {
        let_curve_drift(state, p, time);
    }
}
