#include "blocks.h"

#include "columns.h"
#include "information.h"
#include "real_math.h"
#include "signals.h"
#include "state_variable_filter.h"

static const sh_real DURATION = (sh_real)0.05; /* of a block [s] */
static const sh_real LONGEST = 100000;         /* samples of a block: the start has as many steps */

/* Blocks that are remembered: the misfit is that of the last minutes, so that one that begins after
 * hours is noticed as soon as one that begins after a minute.
 */
static const sh_real LARGEST_COUNT = 2000;

/* Window of a block of `length` samples at sample k. */
static sh_real window(sh_real k, sh_real length)
{
    const sh_real x = (k + (sh_real)0.5) / length;

    return 16 * sh_square(x * (1 - x));
}

void sh_blocks_start(sh_regression_state *state)
{
    sh_blocks *blocks = &state->blocks;
    const sh_filter_design *design = &state->design;
    sh_state_variable_filter filter;
    sh_real of_window = 0, output = 0, second = 0, samples;
    int k;

    sh_information_start(&blocks->all, state->size, SH_INFORMATION_LEAST);
    sh_information_start(&blocks->walking, state->size, SH_INFORMATION_LEAST);
    sh_information_start(&blocks->recent, state->size, 1);
    blocks->length = sh_floor(DURATION / design->T + (sh_real)0.5);
    blocks->length = sh_fmin(sh_fmax(blocks->length, 4), LONGEST);
    samples = blocks->length + sh_floor(30 / (design->w * design->T));
    /* What is left of white noise: the energy of the filtered window. */
    sh_state_variable_filter_start(&filter, 0);
    for (k = 0; k < SH_MOST_SAMPLES && (sh_real)k < samples; ++k) {
        const sh_real place = (sh_real)k;
        const sh_real h = place < blocks->length ? window(place, blocks->length) : 0;

        sh_state_variable_filter_step(&filter, design, h);
        of_window += sh_square(h);
        output += sh_square(sh_state_variable_filter_output(&filter));
        second += sh_square(sh_state_variable_filter_second(&filter, design));
    }
    blocks->energy = output / of_window;
    blocks->energy_second = second / of_window;
}

void sh_blocks_interrupt(sh_blocks *blocks, int size)
{
    int i;

    for (i = 0; i < size + SH_SIDES; ++i) {
        blocks->sum[i] = 0;
    }
    blocks->samples = blocks->weight = blocks->weight_window = 0;
    blocks->window = blocks->window_square = blocks->independent = blocks->rounding = 0;
}

/* Sets work.row to the mean row of the block. Returns its sum of squares. */
static sh_real mean_row(sh_regression_state *state)
{
    sh_real *const row = state->work.row;
    sh_real squares = 0;
    int i;

    for (i = 0; i < state->size + SH_SIDES; ++i) {
        row[i] = state->blocks.sum[i] / state->blocks.weight;
        squares += sh_square(row[i]);
    }
    return squares;
}

static void take_mean_row(sh_regression_state *state, sh_information *a, sh_real w)
{
    (void)mean_row(state);
    (void)sh_information_take(a, state->work.row, w);
}

void sh_blocks_fade(sh_blocks *blocks, sh_real keep)
{
    sh_information_fade(&blocks->all, keep, SH_INFORMATION_LEAST);
    sh_information_fade(&blocks->walking, keep, SH_INFORMATION_LEAST);
    blocks->count *= keep;
}

/* A block is full. Rounding of theta enters as if all samples had the same weight. */
static void end(sh_regression_state *state, const sh_parameters *p)
{
    sh_blocks *blocks = &state->blocks;
    const sh_motor_parameters *motor = &p->motor;
    const sh_real rounding = sh_is_measured(p) ? 0
                                               : sh_square(sh_square(motor->gamma) * motor->B) *
                                                     blocks->rounding / blocks->samples;
    const sh_real variance =
        blocks->weight_window / sh_square(blocks->weight) * blocks->energy +
        rounding * blocks->energy_second * blocks->window_square / sh_square(blocks->window);
    const sh_real count = blocks->independent / blocks->window_square;

    if (!(variance > 0) || !(mean_row(state) / variance <= SH_LARGE)) { /* also if not a number */
        sh_blocks_interrupt(blocks, state->size);
        return;
    }
    take_mean_row(state, &blocks->walking, 1 / variance);
    take_mean_row(state, &blocks->recent, 1 / variance);
    take_mean_row(state, &blocks->all, 1 / variance);
    blocks->count += count;
    blocks->recent_count += count;
    blocks->gained += count * blocks->length * state->design.T;
    if (blocks->count > LARGEST_COUNT) {
        sh_blocks_fade(blocks, LARGEST_COUNT / blocks->count);
    }
    sh_blocks_interrupt(blocks, state->size);
}

void sh_blocks_take(sh_regression_state *state, const sh_parameters *p, const sh_real *x, sh_real w,
                    sh_real last)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real h = window(blocks->samples, blocks->length), wh = w * h;
    int i;

    for (i = 0; i < state->size + SH_SIDES; ++i) {
        blocks->sum[i] += wh * x[i];
    }
    blocks->weight += wh;
    blocks->weight_window += wh * h;
    blocks->window += h;
    blocks->window_square += sh_square(h);
    blocks->independent += sh_square(h) / last;
    blocks->rounding += sh_signals_roughness(state);
    blocks->samples += 1;
    if (blocks->samples >= blocks->length) {
        end(state, p);
    }
}

sh_real sh_blocks_threshold(sh_real N)
{
    return N + 3 * sh_sqrt(2 * N);
}

/* Mean square of the errors of the recent blocks, if it is beyond chance; else 0, and while friction
 * or the curve changes, which they do not contain. The prior, which is among them, is subtracted.
 */
static sh_real recent_misfit(sh_regression_state *state, const sh_parameters *p)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->recent_count;
    sh_real squares;
    int i;

    if (N < SH_BLOCKS_FIRST || state->friction_drifts || p->regression.drift > 0) {
        return 0;
    }
    squares = sh_information_squares(&blocks->recent, state->beta);
    for (i = 0; i < state->size; ++i) {
        squares -= state->beta[i] * state->beta[i];
    }
    return squares > sh_blocks_threshold(N) ? squares / N : 0;
}

void sh_blocks_judge(sh_regression_state *state, const sh_parameters *p)
{
    sh_blocks *blocks = &state->blocks;
    const sh_real N = blocks->count;
    sh_real q, t;

    state->q = state->variance_factor = 1;
    if (N < SH_BLOCKS_FIRST || N <= (sh_real)state->live.information.size) {
        return;
    }
    q = sh_information_squares(state->friction_drifts ? &blocks->walking : &blocks->all,
                               state->beta) /
        (N - (sh_real)state->live.information.size / 2);
    t = sh_blocks_threshold(N) / N;
    state->q = sh_fmax(q, recent_misfit(state, p));
    if (!(p->regression.memory > 0)) { /* switched off */
        return;
    }
    state->variance_factor = sh_fmax(1, state->q);
    if (q > t) {
        state->variance_factor = sh_fmax(state->variance_factor, 1 + (q - t) * sh_fmax(1, N / 5));
    }
}
