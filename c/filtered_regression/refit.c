/* Refits apply a new misfit, or a new choice of columns, to past samples in bounded time (detail 6). A refit computes a
 * new posterior beside the present posterior: each row of the triangular matrix of the data, with its weight, is a
 * sample for the new posterior. A step of the refit takes one row of this matrix, beginning with the last, or two rows
 * while the rows are short. A new row of the regression updates the matrix from the first row to the last. The new
 * posterior also takes the new row, after the unread rows of the matrix have reduced the row. Every second refit is a
 * trial of a group of columns, and the estimate of a trial is not used.
 */
#include <string.h>

#include "constants.h"
#include "regression.h"

/* Returns the section 0..3 of the posterior that contains column i; -1 if the column is not used. Section 1 contains
 * the columns of the spring, so that their variances need few rows of U. Section 2 contains columns of the motor, whose
 * information is changed or whose variance is used. Section 3 contains the group of columns that is tried.
 */
static int place_of(const sh_regression_state *state, const sh_parameters *p, int i)
{
    const sh_column *column = &state->columns.column[i];
    const sh_refit *refit = &state->refit;
    const int group = sh_column_kinds[column->kind].group;

    if (group != 0 &&
        (!sh_column_is_distinct(state, p, i) || (group != refit->trial && !refit->used[group]))) {
        return -1;
    }
    return group != 0 && group == refit->trial ? 3
           : column->kind >= SH_COLUMN_DRIVE   ? 2
           : i < state->columns.spring         ? 1
                                               : 0;
}

/* Chooses columns [size: SH_MAX_COLUMNS] for the refit. Returns their number. */
static int choose_columns(const sh_regression_state *state, const sh_parameters *p, short *chosen)
{
    int places[SH_MAX_COLUMNS] = {0}, size = 0, place, i;

    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < state->columns.size; ++i) {
        places[i] = place_of(state, p, i);
    }
    /*@ loop unroll 4; */
    for (place = 0; place < 4; ++place) {
        /*@ loop unroll SH_MAX_COLUMNS; */
        for (i = 0; i < state->columns.size; ++i) {
            if (size < state->columns.size && place == places[i]) {
                chosen[size++] = (short)i;
            }
        }
    }
    return size;
}

/* Starts a refit. The weight of the data is 1 / kappa^2, or in a trial 1 / max(1, q, q_recent). */
void sh_refit_begin(sh_regression_state *state, const sh_parameters *p)
{
    sh_refit *refit = &state->refit;
    const sh_real weight = 1 / (refit->trial == 0 ? state->variance_factor : state->misfit);
    const int size = choose_columns(state, p, refit->posterior.column);

    sh_information_start(&refit->posterior.information, size, 1);
    refit->posterior.weight = weight;
    refit->posterior.removed = 0;
    refit->posterior.surplus = state->surplus * weight;
    refit->posterior.spread = state->spread * weight * weight;
    refit->unread = state->data.size;
    refit->step = 0;
}

void sh_refit_start(sh_regression_state *state, const sh_parameters *p)
{
    state->variance_factor = state->misfit = 1;
    state->friction_std = p->prior.D_theta;
    sh_refit_begin(state, p);
    state->posterior = state->refit.posterior;
}

/* The next group that can be tried, 0 if there is none. */
static int next_trial(sh_regression_state *state, const sh_parameters *p)
{
    sh_refit *refit = &state->refit;
    int tries, i;

    for (tries = 1; tries < SH_GROUPS; ++tries) {
        refit->last_trial = refit->last_trial % (SH_GROUPS - 1) + 1;
        for (i = 0; i < state->columns.size; ++i) {
            if (sh_column_kinds[state->columns.column[i].kind].group == refit->last_trial &&
                sh_column_is_distinct(state, p, i)) {
                return refit->last_trial;
            }
        }
    }
    return 0;
}

/* ln p(y | with the group) - ln p(y | without) = sum over its columns of (D z^2 - ln D) / 2 */
static sh_real gain_of_evidence(const sh_regression_state *state)
{
    const sh_posterior *posterior = &state->refit.posterior;
    const sh_information *a = &posterior->information;
    sh_real row[SH_MAX_ROW] = {0}, gain = 0;
    int i;

    for (i = 0; i < a->size; ++i) {
        const sh_column *column = &state->columns.column[posterior->column[i]];

        if (sh_column_kinds[column->kind].group == state->refit.trial) {
            const sh_real D = sh_information_sample(a, i, row), z = row[a->size + SH_RIGHT_Y];

            gain += (D * z * z - sh_log(D)) / 2;
        }
    }
    return gain;
}

/* A group is used above a log evidence of 3 + 0.05 N, and no longer below 0.025 N; knees 3 + 0.01 N, and 0.005 N. */
static void decide_about_group(sh_regression_state *state)
{
    sh_refit *refit = &state->refit;
    const int are_knees = refit->trial == sh_column_kinds[SH_COLUMN_POSSIBLE_KNEE].group;
    const sh_real gain = gain_of_evidence(state),
                  per_blocks = (are_knees ? SH_KNEE_GAIN_PER_BLOCK : SH_GAIN_PER_BLOCK) *
                               state->blocks.count;

    if (gain > SH_FIRST_GAIN + per_blocks) {
        refit->used[refit->trial] = 1;
    }
    if (gain < per_blocks / 2) {
        refit->used[refit->trial] = 0;
    }
}

/* Removes noise from the columns of the inertia (detail 7), and then of the motor torque (detail 14). In the other
 * order, the rounding error in the column of the inertia would bias the column of the motor torque.
 */
static void remove_noise(sh_regression_state *state, const sh_parameters *p)
{
    sh_posterior *posterior = &state->refit.posterior;
    int i;

    if (p->prior.B > 0) {
        sh_posterior_remove(posterior, 0, p->prior.B);
    }
    for (i = 0; i < posterior->information.size; ++i) {
        if (state->columns.column[posterior->column[i]].kind == SH_COLUMN_DRIVE) {
            sh_posterior_remove_noise(posterior, p->prior.B, i, &state->noise);
        }
    }
}

/* Std deviation of the relative error of viscous friction. */
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

static void take_row(sh_regression_state *state)
{
    sh_refit *refit = &state->refit;
    const int size = state->columns.size;
    sh_real x[SH_MAX_ROW] = {0}, w;

    refit->unread -= 1;
    w = sh_information_sample(&state->data, refit->unread, x);
    (void)sh_posterior_take(&refit->posterior, x, size, w);
}

/* Returns 1 if the posterior of the refit still takes new rows. From step 1 on, this posterior is in use. */
static int is_open(const sh_refit *refit)
{
    return refit->step <= 1;
}

void sh_data_take(sh_regression_state *state)
{
    const sh_row *row = &state->row;
    const sh_real duration = (sh_real)state->signals.decimation * state->signals.design.T;
    const int size = state->columns.size;
    sh_refit *refit = &state->refit;
    const int unread = refit->unread;
    sh_real x[SH_MAX_ROW], w;

    (void)memcpy(x, row->x, sizeof x);
    w = sh_information_take_rows(&state->data, 0, unread, x, row->w);
    if (is_open(refit)) {
        int i;

        refit->w = unread < size ? w : 0; /* 0: nothing has been read */
        for (i = 0; i < SH_MAX_ROW; ++i) {
            refit->x[i] = i < unread ? 0 : x[i];
        }
    }
    (void)sh_information_take_rows(&state->data, unread, size, x, w);
    refit->time += duration;
    refit->pause += duration;
}

void sh_refit_take(sh_regression_state *state)
{
    sh_refit *refit = &state->refit;

    if (is_open(refit) && refit->w > 0) {
        (void)sh_posterior_take(&refit->posterior, refit->x, state->columns.size, refit->w);
    }
}

/* Steps 0..15 of a refit after its rows. The drift of friction and the forgetting of data come only before a refit that
 * is no trial. Returns SH_NEW_*.
 */
static int end_step(sh_regression_state *state, const sh_parameters *p, int step)
{
    sh_refit *refit = &state->refit;
    const int is_trial = refit->trial != 0;
    int news = 0;

    if (step == 0 && is_trial) {
        decide_about_group(state);
    } else if (step == 0) {
        remove_noise(state, p);
    } else if (step == 1 && !is_trial) {
        sh_posterior_copy(&state->posterior, &refit->posterior);
    } else if (step == 2 && !is_trial) {
        sh_posterior_estimate(state, p->prior.B);
        news = SH_NEW_COEFFICIENTS;
    } else if (step == 3 && !is_trial) {
        state->change.following = 0;
        news = SH_NEW_VARIANCES;
    } else if (step == 4) {
        sh_misfit_judge_recent(state, p);
    } else if (step == 5) {
        sh_misfit_judge(state, p);
    } else if (step == 6) {
        set_friction_std(state, p);
        /* After every refit that changed the estimate, the next refit is a trial. */
        refit->trial =
            !is_trial && state->blocks.count >= SH_FIRST_TRIAL ? next_trial(state, p) : 0;
        refit->pause = 0;
        if (refit->trial != 0) { /* before a trial, nothing else changes */
            refit->step = SH_REFIT_STEPS;
        }
    } else if (step >= 7 && step < SH_REFIT_STEPS - 1) {
        sh_friction_drift(state, refit->time, step - 7);
    } else if (step == SH_REFIT_STEPS - 1) {
        sh_forget(state, p, refit->time);
        refit->time = 0;
    }
    return news;
}

/* Makes the next step of a refit. The work before and after a refit is also distributed over ticks. */
int sh_refit_advance(sh_regression_state *state, const sh_parameters *p)
{
    sh_refit *refit = &state->refit;
    const sh_real count = state->blocks.count;
    /* A refit changes the estimate only little before there are enough blocks. */
    const sh_real pause =
        count < SH_FIRST_TRIAL ? SH_FIRST_PAUSE : SH_REFIT_PAUSE * count * SH_BLOCK;
    int news = 0;

    if (refit->unread > 0) {
        take_row(state);
        if (refit->unread > state->data.size / 2) { /* the last rows are short */
            take_row(state);
        }
    } else if (refit->step < SH_REFIT_STEPS) {
        refit->step += 1;
        news = end_step(state, p, refit->step - 1);
    } else if (refit->pause >= pause) {
        sh_refit_begin(state, p);
    }
    return news;
}
