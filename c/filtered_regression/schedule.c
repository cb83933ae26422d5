/* The schedule of the tick: the steps by which a row becomes data, misfit and the next estimate, distributed over the
 * ticks until the next row (section 15). A step updates one triangular matrix, or three where the curve drifts; with long
 * rows, it makes up to four steps of a refit. When a change is adopted, a step also copies matrices. As the rest of the tick, this file knows all parts; it is
 * the only one in which the order of steps matters.
 */
#include "real_math.h"
#include "regression.h"

/* Process noise of drifting friction, divided by the variance of the friction's prior [1/s]. */
#define SH_FRICTION_DRIFT ((sh_real)1e-3)
/* Duration of a row for each step of a refit in one step of the row [s], and largest number of these steps [1]. A row
 * below 13 ms has one step of the refit, and a row from 26 ms on has four, always fewer than K. With one step in long
 * rows, a wrong choice of columns would last for 0.8 s at 250 Hz. A row of several samples has more samples than steps.
 */
#define SH_TIME_OF_STEP ((sh_real)0.0065)
#define SH_MOST_STEPS 4

/* ---- forgetting and drift ---------------------------------------------------------------- */

/* P += drift time / (v'v + R) v v'. The vector v contains the columns of the curve in the last row, and R is the
 * variance of this row (F22). The drift reduces the information along v and the sum of the weights by the same
 * factor.
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

        sh_samples_drift(&state->samples, v, variance);
        sh_bank_drift(&state->bank, v, variance);
    }
}

static void forget(sh_regression_state *state, const sh_parameters *p)
{
    const sh_real factor = sh_misfit_forgetting(&state->misfit, state->bank.count,
                                                state->posterior.information.size, p);

    if (factor < 1) {
        sh_samples_forget(&state->samples, factor);
        sh_bank_forget(&state->bank, factor);
    }
    if (p->regression.drift > 0) {
        let_curve_drift(state, p, state->schedule.time);
    }
}

static int estimate_coefficients(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)argument;
    sh_coefficients_solve(&state->coefficients, &state->posterior, &state->columns, p);
    return SH_NEW_COEFFICIENTS;
}

/* ---- the jobs of a refit ----------------------------------------------------------------- */

/* Ends the reading of data: a trial decides about its group, and another refit removes the noise in its columns. */
static int finish_posterior(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)argument;
    if (state->refit.trial != 0) {
        sh_refit_decide_about_group(&state->refit, &state->columns, state->bank.count);
    } else {
        sh_refit_remove_noise(&state->refit, &state->columns, &state->samples.noise, p);
    }
    return 0;
}

static int use_posterior(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_refit_close(&state->refit);
    if (state->refit.trial == 0) {
        sh_posterior_copy(&state->posterior, &state->refit.posterior);
    }
    return 0;
}

static int use_coefficients(sh_regression_state *state, const sh_parameters *p, int argument)
{
    return state->refit.trial == 0 ? estimate_coefficients(state, p, argument) : 0;
}

static int use_variances(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    if (state->refit.trial != 0) {
        return 0;
    }
    sh_bank_followed(&state->bank);
    return SH_NEW_VARIANCES;
}

static int judge_blocks(sh_regression_state *state, const sh_parameters *p, int argument)
{
    const sh_bank *bank = &state->bank;

    (void)argument;
    sh_misfit_judge(&state->misfit, sh_bank_present(bank), bank->prior, bank->count,
                    state->coefficients.beta, state->posterior.information.size, p);
    return 0;
}

/* Ends a refit. Once there are enough blocks, a trial follows each refit that changed the estimate, if there is a group
 * to try. Drift and forgetting then wait until the trial ends, so that the trial has the same data.
 */
static int end_refit(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)argument;
    sh_coefficients_judge_viscous(&state->coefficients, &state->posterior, &state->columns, p);
    if (sh_refit_end(&state->refit, &state->columns, &state->signals, state->bank.count, p)) {
        state->schedule.refit_job = SH_REFIT_JOBS;
    }
    return 0;
}

/* Prepares the drift of friction of a kind in the bank, and in the samples if the blocks show that friction drifts. */
static int prepare_drift_of_bank(sh_regression_state *state, const sh_parameters *p, int kind)
{
    (void)p;
    sh_bank_prepare_drift(&state->bank, sh_columns_place(&state->columns, kind),
                          SH_FRICTION_DRIFT * state->schedule.time);
    return 0;
}

static int prepare_drift_of_samples(sh_regression_state *state, const sh_parameters *p, int kind)
{
    const int column = sh_columns_place(&state->columns, kind);

    (void)p;
    sh_samples_prepare_drift(&state->samples, state->bank.friction_drifts ? column : -1,
                             SH_FRICTION_DRIFT * state->schedule.time);
    return 0;
}

static int take_drift_of_bank(sh_regression_state *state, const sh_parameters *p, int judge)
{
    (void)p;
    sh_bank_take_drift(&state->bank);
    if (judge) {
        sh_bank_judge_drift(&state->bank);
    }
    return 0;
}

static int take_drift_of_samples(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_samples_take_drift(&state->samples);
    return 0;
}

static int forget_data(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)argument;
    forget(state, p);
    state->schedule.time = 0;
    return 0;
}

/* A job returns SH_NEW_*. */
typedef struct {
    int (*make)(sh_regression_state *state, const sh_parameters *p, int argument);
    int argument;
} sh_job;

/* What a refit does behind the rows of the data, one job in each step. */
static const sh_job REFIT[SH_REFIT_JOBS] = {
    {finish_posterior, 0},
    {use_posterior, 0},
    {use_coefficients, 0},
    {use_variances, 0},
    {judge_blocks, 0},
    {end_refit, 0},
    {prepare_drift_of_bank, SH_COLUMN_VISCOUS},
    {take_drift_of_bank, 0},
    {prepare_drift_of_bank, SH_COLUMN_COULOMB},
    {take_drift_of_bank, 1},
    {prepare_drift_of_samples, SH_COLUMN_VISCOUS},
    {take_drift_of_samples, 0},
    {prepare_drift_of_samples, SH_COLUMN_COULOMB},
    {take_drift_of_samples, 0},
    {forget_data, 0},
};

/* Makes the next job of a table, and counts it. Returns SH_NEW_*. */
static int make_next(const sh_job *table, int *next, sh_regression_state *state,
                     const sh_parameters *p)
{
    const sh_job *job = &table[*next];

    *next += 1;
    return job->make(state, p, job->argument);
}

/* Starts a refit. The weight of the data is 1 / kappa^2, or in a trial 1 / max(1, q). */
static void begin_refit(sh_regression_state *state, const sh_parameters *p)
{
    const sh_misfit *misfit = &state->misfit;

    sh_refit_begin(&state->refit, &state->columns, &state->signals, &state->samples,
                   state->refit.trial == 0 ? misfit->variance_factor : misfit->square, p);
    state->schedule.refit_job = 0;
}

/* Makes one step of a refit: reads one or two rows of the data, or makes the next job. Returns SH_NEW_*. */
static int advance_refit(sh_regression_state *state, const sh_parameters *p)
{
    sh_schedule *schedule = &state->schedule;

    if (sh_refit_read(&state->refit, &state->samples.data)) {
        return 0;
    }
    if (schedule->refit_job < SH_REFIT_JOBS) {
        return make_next(REFIT, &schedule->refit_job, state, p);
    }
    if (sh_refit_is_due(&state->refit, state->bank.count, state->block.duration)) {
        begin_refit(state, p);
    }
    return 0;
}

/* ---- a block ----------------------------------------------------------------------------- */

/* Adopts the hypothesis that the bank found: its matrix also replaces the data of all samples, because their samples
 * before the change contradict its information about the motor. The next posterior contains the prior twice, because the
 * blocks also contain the prior, but the blocks soon outweigh the prior. The sums that describe the noise of single
 * samples begin at 0, because blocks hardly contain this noise. The number of blocks and their squares stay.
 */
static void adopt(sh_regression_state *state, const sh_parameters *p, sh_finding found)
{
    if (found == SH_FOUND_NOTHING) {
        return;
    }
    sh_bank_adopt(&state->bank, &state->columns, state->coefficients.beta, found);
    sh_misfit_begin_anew(&state->misfit);
    sh_samples_replace(&state->samples, &state->bank.constant);
    sh_refit_drop_trial(&state->refit);
    begin_refit(state, p);
    if (found == SH_FOUND_SPRING) {
        state->change_age = 0;
    }
}

static int take_block_for_spring(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_bank_take_for_spring(&state->bank, &state->columns, state->coefficients.beta,
                            &state->block_mean);
    return 0;
}

static int take_block_as_before(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_bank_take_as_before(&state->bank, &state->block_mean);
    return 0;
}

static int take_block_for_friction(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_bank_take_for_friction(&state->bank, &state->block_mean);
    return 0;
}

/* Counts the block, and judges what the hypotheses predicted. */
static int judge_hypotheses(sh_regression_state *state, const sh_parameters *p, int argument)
{
    sh_misfit *misfit = &state->misfit;

    (void)argument;
    sh_bank_count(&state->bank, state->block_mean.count);
    if (p->regression.memory > 0) {
        sh_misfit_learn(misfit, state->block_mean.duration);
    }
    adopt(state, p,
          sh_bank_judge(&state->bank, &state->columns, state->coefficients.beta, misfit->judged,
                        misfit->usual, p));
    return 0;
}

/* What a full block does: each job updates the matrix of one hypothesis. Another spring is first, because this
 * hypothesis may begin anew before this block.
 */
static const sh_job BLOCK[SH_BLOCK_JOBS] = {
    {take_block_for_spring, 0},
    {take_block_as_before, 0},
    {take_block_for_friction, 0},
    {judge_hypotheses, 0},
};

/* Makes the next job of the last full block. Returns 0 if all are done. */
static int advance_block(sh_regression_state *state, const sh_parameters *p)
{
    if (state->schedule.block_job >= SH_BLOCK_JOBS) {
        return 0;
    }
    (void)make_next(BLOCK, &state->schedule.block_job, state, p);
    return 1;
}

/* Adds the last row to the block, unless a gap in the samples follows the row. */
static void take_row_in_block(sh_regression_state *state, const sh_parameters *p)
{
    if (!state->schedule.interrupted && sh_block_take(&state->block, &state->row, &state->signals,
                                                      state->columns.size, p, &state->block_mean)) {
        state->schedule.block_job = 0;
    }
}

/* ---- a row ------------------------------------------------------------------------------- */

static int estimate_variances(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)state;
    (void)p;
    (void)argument;
    return SH_NEW_VARIANCES;
}

static int take_row_as_sample(sh_regression_state *state, const sh_parameters *p, int argument)
{
    const sh_real duration = (sh_real)state->signals.decimation * state->signals.design.T;
    sh_refit *refit = &state->refit;

    (void)p;
    (void)argument;
    sh_samples_take(&state->samples, &state->row, refit->unread, refit->is_open ? &refit->rest : 0);
    sh_refit_wait(refit, duration);
    state->schedule.time += duration;
    return 0;
}

static int take_rest_of_row(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)p;
    (void)argument;
    sh_refit_take_rest(&state->refit, state->columns.size);
    return 0;
}

/* Returns the number of steps that a refit makes in one step of a row. */
static int steps_of_refit(const sh_signals *signals)
{
    const int K = signals->decimation;
    int steps = SH_MOST_STEPS;

    while (steps > 1 &&
           (steps >= K || (sh_real)steps * SH_TIME_OF_STEP > (sh_real)K * signals->design.T)) {
        steps -= 1;
    }
    return steps;
}

/* Makes step 0, 1 or 2 after a row. If the row completes a block, these steps, and step 0 after the next row, take the
 * block. Otherwise, the test of other friction or the refit makes its next steps: several if rows are long, so that the
 * duration of a refit does not depend on the length of the rows.
 */
static int advance_others(sh_regression_state *state, const sh_parameters *p, int step)
{
    const int steps = steps_of_refit(&state->signals);
    int is_busy = advance_block(state, p), news = 0, i;

    if (step == 0) {
        take_row_in_block(state, p);
    }
    is_busy = is_busy || advance_block(state, p);
    if (!is_busy && sh_bank_is_widening(&state->bank, &state->columns)) {
        sh_bank_widen_friction(&state->bank, step);
        is_busy = 1;
    }
    for (i = 0; i < steps && !is_busy; ++i) {
        news |= advance_refit(state, p);
    }
    return news;
}

static const sh_job ROW[SH_ROW_JOBS] = {
    {estimate_coefficients, 0}, {estimate_variances, 0}, {take_row_as_sample, 0},
    {take_rest_of_row, 0},      {advance_others, 0},     {advance_others, 1},
    {advance_others, 2},
};

/* ---- the ticks --------------------------------------------------------------------------- */

void sh_schedule_start(sh_regression_state *state, const sh_parameters *p)
{
    const sh_schedule nothing = {0};

    state->schedule = nothing;
    state->schedule.tick = state->signals.decimation; /* there is no row yet, and no block */
    state->schedule.block_job = SH_BLOCK_JOBS;
    sh_refit_start(&state->refit);
    begin_refit(state, p);
    sh_posterior_copy(&state->posterior, &state->refit.posterior);
}

void sh_schedule_row(sh_schedule *schedule)
{
    schedule->tick = 0;
    schedule->interrupted = 0;
}

void sh_schedule_interrupt(sh_schedule *schedule)
{
    schedule->interrupted = 1;
}

/* Returns the first job that belongs to a tick after the row, if all jobs are distributed over `ticks` ticks. */
static int first_job(int tick, int ticks)
{
    return (SH_ROW_JOBS * tick + ticks - 1) / ticks;
}

int sh_schedule_advance(sh_regression_state *state, const sh_parameters *p)
{
    const int ticks = state->signals.decimation > 1 ? state->signals.decimation - 1 : 1;
    const int tick = state->schedule.tick;
    int news = 0, job, end;

    if (tick < 0 || tick >= ticks) { /* all jobs are done */
        return 0;
    }
    state->schedule.tick = tick + 1;
    end = first_job(tick + 1, ticks);
    for (job = first_job(tick, ticks); job < end && job < SH_ROW_JOBS; ++job) {
        news |= ROW[job].make(state, p, ROW[job].argument);
    }
    return news;
}
