/* Method FilteredRegression: which states can be its own. Each condition is an `if` about a member, so that
 * an analyser knows the member behind it.
 */
#include <string.h>

#include "constants.h"
#include "method.h"
#include "regression.h"

/* Columns never change after the start. */
static int are_columns(const sh_columns *columns, const sh_parameters *p)
{
    const int count = sh_columns_count(p);
    sh_columns started;
    int i;

    if (count < 1 || count > SH_MAX_COLUMNS || columns->size != count ||
        columns->has_nominal != sh_has_nominal_curve(p)) {
        return 0;
    }
    (void)memset(&started, 0, sizeof started);
    sh_columns_start(&started, p);
    if (columns->spring != started.spring || columns->knees != started.knees ||
        columns->filtered != started.filtered || columns->friction != started.friction ||
        columns->inertia != started.inertia) {
        return 0;
    }
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* those behind are zero */
        if (columns->column[i].kind != started.column[i].kind ||
            columns->column[i].i != started.column[i].i ||
            columns->column[i].j != started.column[i].j) {
            return 0;
        }
    }
    return 1;
}

/* Whether each system of normal equations has as many unknowns as there are columns. */
static int are_data(const sh_regression_state *state)
{
    const sh_blocks *blocks = &state->blocks;
    const int size = state->columns.size;

    if (state->data.size != size || blocks->constant.size != size ||
        blocks->drifting.size != size || blocks->recent.size != size ||
        state->change.changed.size != size) {
        return 0;
    }
    return 1;
}

/* A posterior has a choice of the columns. */
static int is_choice(const sh_regression_state *state, const sh_posterior *posterior)
{
    int i;

    if (posterior->information.size < 1 || posterior->information.size > state->columns.size) {
        return 0;
    }
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* also behind the choice: of an earlier one, or zero */
        if (posterior->column[i] < 0 || posterior->column[i] >= state->columns.size) {
            return 0;
        }
    }
    return 1;
}

/* Where the present refit stands: refit.c takes the rows of the data, and then some more steps. */
static int is_refit(const sh_refit *refit, int size)
{
    int i;

    if (refit->unread < 0 || refit->unread > size || refit->step < 0 ||
        refit->step > SH_REFIT_STEPS || refit->trial < 0 || refit->trial >= SH_GROUPS ||
        refit->last_trial < 0 || refit->last_trial >= SH_GROUPS) {
        return 0;
    }
    for (i = 0; i < SH_GROUPS; ++i) {
        if (refit->used[i] < 0 || refit->used[i] > 1) {
            return 0;
        }
    }
    return 1;
}

/* Where the rows stand, and flags. */
static int are_numbers(const sh_regression_state *state)
{
    if (state->modality < SH_MODALITY_RESIDUAL || state->modality > SH_MODALITY_MODEL ||
        state->signals.decimation < 1 || state->signals.decimation > SH_LARGEST_DECIMATION ||
        state->mean.samples < 0 || state->mean.samples >= state->signals.decimation ||
        state->row.tick < 0 || state->row.tick > SH_LARGEST_DECIMATION ||
        state->signals.begun < 0 || state->signals.begun > 1 || state->friction_drifts < 0 ||
        state->friction_drifts > 1 || state->stiffness_known < 0 || state->stiffness_known > 1 ||
        state->change.following < 0 || state->change.following > 1 || state->change.widened < 0 ||
        state->change.widened > SH_MAX_COLUMNS) {
        return 0;
    }
    return 1;
}

int sh_filtered_regression_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    const sh_regression_state *state = &estimator->method.regression;

    if (!are_numbers(state) || !are_columns(&state->columns, p) || !are_data(state) ||
        !is_choice(state, &state->posterior) || !is_choice(state, &state->refit.posterior) ||
        !is_refit(&state->refit, state->columns.size)) {
        return 1;
    }
    return 0;
}
