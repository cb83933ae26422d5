/* The schedule of the tick: the steps by which a row becomes data, misfit and the next estimate, distributed over the
 * ticks until the next row (detail 16). A step changes at most one triangular matrix, or up to four in a refit with long
 * rows. When a change is adopted, a step also copies matrices. As the rest of the tick, this file knows all parts; it is
 * the only one in which the order of steps matters.
 */
#include "real_math.h"
#include "regression.h"

/* Process noise of drifting friction, divided by the variance of the friction's prior [1/s]. */
#define SH_FRICTION_DRIFT ((sh_real)1e-3)
/* Duration of a row for each step of a refit in one step of the row [s], and largest number of these steps [1]. A row
 * below 13 ms has one step of the refit, and a row from 26 ms on has four. With one step in long rows, a wrong choice
 * of columns would last for 0.8 s at 250 Hz. A row of several samples has more samples than steps.
 */
#define SH_TIME_OF_STEP ((sh_real)0.0065)
#define SH_MOST_STEPS 4

/* ---- forgetting and drift ---------------------------------------------------------------- */

/* P += drift time / (v'v + R) v v'. The vector v contains the columns of the curve in the last row, and R is the
 * variance of this row (detail 11). The drift reduces the information along v and the sum of the weights by the same
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

/* Forgets data that contradict the model. The time of forgetting is the duration of the blocks, so no data are forgotten
 * at rest or with few blocks.
 */
static void forget(sh_regression_state *state, const sh_parameters *p)
{
    const sh_real moving = sh_misfit_forget_recent(&state->misfit, p);

    if (sh_misfit_contradicts(&state->misfit, state->bank.count,
                              state->posterior.information.size)) {
        const sh_real factor = sh_misfit_forgetting(&state->misfit, moving, p);

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
    sh_posterior_estimate(&state->posterior, state->columns.size, p->prior.B, state->beta,
                          state->per_gain);
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

/* While friction or the curve drifts, the recent blocks are not judged, because they do not contain this drift. */
static int judge_recent_blocks(sh_regression_state *state, const sh_parameters *p, int argument)
{
    const int drifts = state->bank.friction_drifts || p->regression.drift > 0;

    (void)argument;
    sh_misfit_judge_recent(&state->misfit, state->beta, drifts);
    return 0;
}

static int judge_blocks(sh_regression_state *state, const sh_parameters *p, int argument)
{
    const sh_bank *bank = &state->bank;

    (void)argument;
    sh_misfit_judge(&state->misfit, sh_bank_present(bank), bank->prior, bank->count, state->beta,
                    state->posterior.information.size, p);
    return 0;
}

/* Sets the std deviation of the relative error of viscous friction. */
static void set_friction_std(sh_regression_state *state, const sh_parameters *p)
{
    const sh_columns *columns = &state->columns;
    const int i = sh_columns_place(columns, SH_COLUMN_VISCOUS);

    if (i >= 0) {
        sh_real c[SH_MAX_COLUMNS] = {0};

        c[i] = columns->column[i].prior;
        state->friction_std = sh_std_deviation(
            sh_posterior_variances(&state->posterior, p->prior.B, c, c, columns->size).first);
    }
}

/* Ends a refit. After every refit that changed the estimate, the next refit is a trial. Before a trial, nothing else
 * changes, so the other jobs are left out.
 */
static int end_refit(sh_regression_state *state, const sh_parameters *p, int argument)
{
    (void)argument;
    set_friction_std(state, p);
    if (sh_refit_end(&state->refit, &state->columns, &state->signals, state->bank.count, p)) {
        state->schedule.job = SH_REFIT_JOBS;
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
    {judge_recent_blocks, 0},
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

/* Starts a refit. The weight of the data is 1 / kappa^2, or in a trial 1 / max(1, q, q_recent). */
static void begin_refit(sh_regression_state *state, const sh_parameters *p)
{
    const sh_misfit *misfit = &state->misfit;

    sh_refit_begin(&state->refit, &state->columns, &state->signals, &state->samples,
                   state->refit.trial == 0 ? misfit->variance_factor : misfit->square, p);
    state->schedule.job = 0;
}

/* Makes one step of a refit: reads one or two rows of the data, or makes the next job. Returns SH_NEW_*. */
static int advance_refit(sh_regression_state *state, const sh_parameters *p)
{
    sh_schedule *schedule = &state->schedule;

    if (sh_refit_read(&state->refit, &state->samples.data)) {
        return 0;
    }
    if (schedule->job < SH_REFIT_JOBS) {
        const sh_job *job = &REFIT[schedule->job];

        schedule->job += 1;
        return job->make(state, p, job->argument);
    }
    if (sh_refit_is_due(&state->refit, state->bank.count)) {
        begin_refit(state, p);
    }
    return 0;
}

/* ---- a block ----------------------------------------------------------------------------- */

/* Adopts the hypothesis that the bank found: its matrix also replaces the data of all samples, because their samples
 * before the change contradict its information about the motor. The next posterior contains the prior twice, because the
 * blocks also contain the prior, but the blocks soon outweigh the prior. The sums that describe the noise of single
 * samples begin at 0, because blocks hardly contain this noise.
 */
static void adopt(sh_regression_state *state, const sh_parameters *p, sh_finding found)
{
    if (found == SH_FOUND_NOTHING) {
        return;
    }
    sh_bank_adopt(&state->bank, &state->columns, found);
    sh_misfit_begin_anew(&state->misfit);
    sh_samples_replace(&state->samples, &state->bank.constant);
    sh_refit_drop_trial(&state->refit);
    begin_refit(state, p);
    if (found == SH_FOUND_SPRING) {
        state->change_age = 0;
    }
}

/* Counts the block, and judges what the hypotheses predicted. */
static void finish_block(sh_regression_state *state, const sh_parameters *p, const sh_real *mean,
                         sh_real w)
{
    const sh_signals *signals = &state->signals;
    const sh_real count = sh_block_count(&state->block);
    const sh_real samples = state->block.length * (sh_real)signals->decimation;
    sh_misfit *misfit = &state->misfit;

    sh_misfit_take(misfit, mean, w, count, count * samples * signals->design.T);
    sh_bank_count(&state->bank, count);
    if (p->regression.memory > 0) {
        sh_misfit_learn(misfit);
    }
    adopt(state, p, sh_bank_judge(&state->bank, &state->columns, misfit->judged, misfit->usual, p));
    sh_block_empty(&state->block);
}

/* Makes step 0..3 with the mean row of a full block: each step updates the matrix of one hypothesis. Another spring is
 * first, because this hypothesis may begin anew before this block.
 */
static void take_block_in_steps(sh_regression_state *state, const sh_parameters *p, int step)
{
    sh_real mean[SH_MAX_ROW] = {0}, w;

    if (!sh_block_is_full(&state->block)) {
        return;
    }
    w = sh_block_mean(&state->block, &state->signals, state->columns.size, p, mean);
    if (!(w > 0)) {
        sh_block_empty(&state->block);
    } else if (step == 0) {
        sh_bank_take_for_spring(&state->bank, &state->columns, mean, w);
    } else if (step == 1) {
        sh_bank_take_as_before(&state->bank, mean, w);
    } else if (step == 2) {
        sh_bank_take_for_friction(&state->bank, mean, w);
    } else {
        finish_block(state, p, mean, w);
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
static int advance_block(sh_regression_state *state, const sh_parameters *p, int step)
{
    const int was_full = sh_block_is_full(&state->block), steps = steps_of_refit(&state->signals);
    int news = 0, i;

    if (step == 0) {
        take_block_in_steps(state, p, 3);
        sh_block_take(&state->block, &state->row, state->columns.size);
    }
    take_block_in_steps(state, p, step);
    if (was_full || sh_block_is_full(&state->block) ||
        sh_bank_widen_friction(&state->bank, &state->columns, step)) {
        return 0;
    }
    for (i = 0; i < steps; ++i) {
        news |= advance_refit(state, p);
    }
    return news;
}

static const sh_job ROW[SH_ROW_JOBS] = {
    {estimate_coefficients, 0}, {estimate_variances, 0}, {take_row_as_sample, 0},
    {take_rest_of_row, 0},      {advance_block, 0},      {advance_block, 1},
    {advance_block, 2},
};

/* ---- the ticks --------------------------------------------------------------------------- */

void sh_schedule_start(sh_regression_state *state, const sh_parameters *p)
{
    state->schedule.tick = state->signals.decimation; /* there is no row yet */
    state->friction_std = p->prior.D_theta;
    begin_refit(state, p);
    state->posterior = state->refit.posterior;
}

void sh_schedule_row(sh_schedule *schedule)
{
    schedule->tick = 0;
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
