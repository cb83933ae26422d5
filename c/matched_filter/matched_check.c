/* Method MatchedFilter: which states can be its own. */
#include "columns.h"
#include "method.h"

/* Columns never change after the start. */
static int are_columns(const sh_matched_state *state, const sh_parameters *p)
{
    sh_column started[SH_MAX_COLUMNS];
    const int count = sh_columns_count(p);
    int i;

    if (!sh_is_within(count, 1, SH_MAX_COLUMNS) || state->size != count ||
        state->has_nominal != sh_has_nominal_curve(p)) {
        return 0;
    }
    sh_columns_list(p, started);
    for (i = 0; i < count; ++i) {
        if (state->column[i].kind != started[i].kind ||
            state->column[i].index != started[i].index) {
            return 0;
        }
    }
    return 1;
}

/* The data of all samples have every column. */
static int are_data(const sh_matched_state *state)
{
    const sh_blocks *blocks = &state->blocks;

    return state->data.size == state->size && state->frozen.size == state->size &&
           blocks->all.size == state->size && blocks->walking.size == state->size &&
           blocks->recent.size == state->size;
}

/* A posterior has a choice of the columns, and knows where two of them are. */
static int is_posterior(const sh_matched_state *state, const sh_posterior *posterior)
{
    const int size = posterior->information.size;
    int coulomb = -1, inertia = -1, i;

    if (!sh_is_within(size, 1, state->size)) {
        return 0;
    }
    for (i = 0; i < size; ++i) {
        const int column = posterior->column[i];

        if (!sh_is_within(column, 0, state->size - 1)) {
            return 0;
        }
        if (state->column[column].kind == SH_COLUMN_COULOMB) {
            coulomb = i;
        }
        if (state->column[column].kind == SH_COLUMN_INERTIA) {
            inertia = i;
        }
    }
    return posterior->coulomb == coulomb && posterior->inertia == inertia;
}

/* Where the present pass stands: passes.c takes the rows of the data, and then three more steps. */
static int is_pass(const sh_matched_state *state)
{
    return sh_is_within(state->row, 0, state->size + 3) && sh_is_within(state->alternate, 0, 1) &&
           sh_is_within(state->trial, 0, SH_GROUPS - 1) &&
           sh_is_within(state->last_trial, 0, SH_GROUPS - 1);
}

static int are_flags(const sh_matched_state *state)
{
    int i;

    for (i = 0; i < SH_GROUPS; ++i) {
        if (!sh_is_within(state->used[i], 0, 1)) {
            return 0;
        }
    }
    return sh_is_within(state->begun, 0, 1) && sh_is_within(state->friction_drifts, 0, 1) &&
           sh_is_within(state->stiffness_known, 0, 1);
}

int sh_matched_filter_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    const sh_matched_state *state = &estimator->method.matched;

    return !sh_is_within(state->modality, SH_MODALITY_RESIDUAL, SH_MODALITY_MODEL) ||
           !are_columns(state, p) || !are_data(state) || !is_posterior(state, &state->live) ||
           !is_posterior(state, &state->build) || !is_pass(state) || !are_flags(state);
}
