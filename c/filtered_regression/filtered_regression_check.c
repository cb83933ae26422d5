/* Checks whether a state, for example from a file, is a possible state of the method FilteredRegression. A condition
 * about one member is an `if`, so that a static analyser knows the range of the member after the condition. Numbers
 * that only have a range are in a table.
 */
#include <string.h>

#include "method.h"
#include "real_math.h"
#include "regression.h"

/* End of the range of regression.decimation [1]. */
#define SH_LARGEST_DECIMATION 64

/* Returns 1 if the columns are equal to the columns at the start. Columns never change after the start. */
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

/* Returns 1 if the indices of the columns that a posterior uses are in their range. */
static int is_choice(const sh_regression_state *state, const sh_posterior *posterior)
{
    const int size = state->columns.size;
    int i;

    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* also behind the choice: of an earlier one, or zero */
        if (posterior->column[i] < 0 || posterior->column[i] >= size) {
            return 0;
        }
    }
    return 1;
}

/* Returns 1 if all sizes, step counters and flags are in their ranges. */
static int are_numbers(const sh_regression_state *state)
{
    const sh_bank *bank = &state->bank;
    const sh_refit *refit = &state->refit;
    const int size = state->columns.size;
    const struct {
        const int *number;
        int least, most;
    } ranges[] = {
        {&state->modality, SH_MODALITY_RESIDUAL, SH_MODALITY_MODEL},
        {&bank->friction_drifts, 0, 1},
        {&state->feedback.stiffness_known, 0, 1},
        {&state->gate.samples, 0, SH_MOST_TICKS},
        {&state->gate.skipped, 0, SH_MOST_TICKS},
        {&state->signals.begun, 0, 1},
        {&state->signals.decimation, 1, SH_LARGEST_DECIMATION},
        {&state->mean.samples, 0, SH_LARGEST_DECIMATION},
        {&state->schedule.tick, 0, SH_LARGEST_DECIMATION},
        {&state->samples.data.size, size, size},
        {&state->posterior.information.size, 1, size},
        {&refit->posterior.information.size, 1, size},
        {&refit->unread, 0, size},
        {&refit->is_open, 0, 1},
        {&state->schedule.block_job, 0, SH_BLOCK_JOBS},
        {&state->schedule.refit_job, 0, SH_REFIT_JOBS},
        {&state->schedule.interrupted, 0, 1},
        {&refit->trial, 0, SH_GROUPS - 1},
        {&refit->last_trial, 0, SH_GROUPS - 1},
        {&bank->constant.size, size, size},
        {&bank->friction.size, size, size},
        {&bank->spring.size, size, size},
        {&bank->following, 0, 1},
        {&bank->widened, 0, SH_MAX_COLUMNS},
        {&state->rest.taken, 0, SH_LONGEST_REST + 1},
        {&state->rest.most, 1, SH_LONGEST_REST},
        {&state->rest.next, 2, 2 * SH_LONGEST_REST},
        {&state->change_age, -1, SH_MOST_TICKS},
    };
    const int count = sizeof ranges / sizeof ranges[0];
    int i;

    /*@ loop unroll 28; */
    for (i = 0; i < count; ++i) {
        if (*ranges[i].number < ranges[i].least || *ranges[i].number > ranges[i].most) {
            return 0;
        }
    }
    /*@ loop unroll SH_GATE_SIGNALS; */
    for (i = 0; i < SH_GATE_SIGNALS; ++i) {
        if (state->gate.signal[i].refused < 0 || state->gate.signal[i].refused > SH_MOST_TICKS) {
            return 0;
        }
    }
    /*@ loop unroll SH_GROUPS; */
    for (i = 0; i < SH_GROUPS; ++i) {
        if (refit->used[i] < 0 || refit->used[i] > 1) {
            return 0;
        }
    }
    if (state->mean.samples >= state->signals.decimation) {
        return 0;
    }
    return 1;
}

int sh_filtered_regression_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    const sh_regression_state *state = &estimator->method.regression;

    if (!are_columns(&state->columns, p) || !are_numbers(state) ||
        !is_choice(state, &state->posterior) || !is_choice(state, &state->refit.posterior)) {
        return 1;
    }
    return 0;
}
