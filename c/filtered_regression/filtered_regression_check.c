/* Method FilteredRegression: which states can be its own. Each condition is an `if` about a member, so that
 * an analyser knows the member behind it.
 */
#include "columns.h"
#include "method.h"

/* Columns never change after the start. */
static int are_columns(const sh_regression_state *state, const sh_parameters *p)
{
    sh_column started[SH_MAX_COLUMNS] = {{0, 0, 0, 0}};
    const int count = sh_columns_count(p);
    int i;

    if (count < 1 || count > SH_MAX_COLUMNS || state->size != count ||
        state->has_nominal != sh_has_nominal_curve(p)) {
        return 0;
    }
    sh_columns_list(p, started);
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* those behind are zero */
        if (state->column[i].kind != started[i].kind ||
            state->column[i].index != started[i].index) {
            return 0;
        }
    }
    return 1;
}

/* The data of all samples have every column. */
static int are_data(const sh_regression_state *state)
{
    const sh_blocks *blocks = &state->blocks;

    if (state->data.size != state->size || state->frozen.size != state->size ||
        blocks->all.size != state->size || blocks->walking.size != state->size ||
        blocks->recent.size != state->size) {
        return 0;
    }
    return 1;
}

/* A posterior has a choice of the columns. */
static int is_choice(const sh_regression_state *state, const sh_posterior *posterior)
{
    int i;

    if (posterior->information.size < 1 || posterior->information.size > state->size) {
        return 0;
    }
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* also behind the choice: of an earlier one, or zero */
        if (posterior->column[i] < 0 || posterior->column[i] >= state->size) {
            return 0;
        }
    }
    return 1;
}

/* A posterior knows where two of its columns are. */
static int knows_motor(const sh_regression_state *state, const sh_posterior *posterior)
{
    int coulomb = -1, inertia = -1, i;

    for (i = 0; i < posterior->information.size; ++i) {
        const int kind = state->column[posterior->column[i]].kind;

        if (kind == SH_COLUMN_COULOMB) {
            coulomb = i;
        }
        if (kind == SH_COLUMN_INERTIA) {
            inertia = i;
        }
    }
    if (posterior->coulomb != coulomb || posterior->inertia != inertia) {
        return 0;
    }
    return 1;
}

/* Where the present pass stands: passes.c takes the rows of the data, and then three more steps. */
static int is_pass(const sh_regression_state *state)
{
    if (state->row < 0 || state->row > state->size + 3 || state->alternate < 0 ||
        state->alternate > 1 || state->trial < 0 || state->trial >= SH_GROUPS ||
        state->last_trial < 0 || state->last_trial >= SH_GROUPS) {
        return 0;
    }
    return 1;
}

static int are_flags(const sh_regression_state *state)
{
    int i;

    for (i = 0; i < SH_GROUPS; ++i) {
        if (state->used[i] < 0 || state->used[i] > 1) {
            return 0;
        }
    }
    if (state->begun < 0 || state->begun > 1 || state->friction_drifts < 0 ||
        state->friction_drifts > 1 || state->stiffness_known < 0 || state->stiffness_known > 1) {
        return 0;
    }
    return 1;
}

int sh_filtered_regression_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    const sh_regression_state *state = &estimator->method.regression;

    if (state->modality < SH_MODALITY_RESIDUAL || state->modality > SH_MODALITY_MODEL ||
        !are_columns(state, p) || !are_data(state) || !is_choice(state, &state->live) ||
        !knows_motor(state, &state->live) || !is_choice(state, &state->build) ||
        !knows_motor(state, &state->build) || !is_pass(state) || !are_flags(state)) {
        return 1;
    }
    return 0;
}
