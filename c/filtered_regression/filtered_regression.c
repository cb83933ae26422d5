/* Method FilteredRegression: one tick, and what its estimate means. */
#include <string.h>

#include "constants.h"
#include "information.h"
#include "method.h"
#include "posterior.h"
#include "regression.h"
#include "state_variable_filter.h"

static int check_filtered_regression(const sh_parameters *p, sh_violation *violation)
{
    const sh_real wT = p->regression.bandwidth * p->samplePeriod;

    if (wT < (sh_real)1e-4 || wT >= 2) {
        return sh_violates(violation, "regression.bandwidth", p->regression.bandwidth,
                           ">= 1e-4 / samplePeriod and < 2 / samplePeriod");
    }
    if (!(p->prior.tau_e > 0) && !(sh_has_nominal_curve(p) && p->prior.nominal > 0)) {
        return sh_violates(violation, "prior.tau_e", p->prior.tau_e,
                           "> 0, or 0 with a curve rls.eta_0 and prior.nominal > 0");
    }
    if (sh_columns_count(p) > SH_MAX_COLUMNS) {
        return sh_violates(violation, "rls.n", (sh_real)p->rls.n,
                           "smaller, or more priors 0: this library was compiled for at "
                           "most " SH_TEXT_OF(SH_MAX_COLUMNS) " columns");
    }
    return 0;
}

/* Largest |phi|: there the highest power e is 32 times as large as at range.phi; at least twice it. */
static sh_real largest_deformation_filtered_regression(const sh_parameters *p)
{
    const int e = sh_power_of_phi(p->rls.symmetric, p->rls.n - 1);

    return p->range.phi * sh_fmax(SH_LEAST_LIMIT, sh_exp(sh_log(SH_LARGEST_POWER) / (sh_real)e));
}

/* ---- torque and stiffness at a point ------------------------------------------------------ */

/* Share by which the rounding of phi makes the stiffness too small: v sum V_phi / R, where v is its
 * variance, to first order and as if it were the same in all samples (point 5). The estimate is not
 * corrected by it, because slopes differ; it widens the interval.
 */
static sh_real attenuation(const sh_regression_state *state, const sh_combination *stiffness)
{
    return state->rounding * state->posterior.weight * stiffness->variance;
}

/* sqrt(c' P c + (s_g d(c' beta)/dg)^2 + (attenuation c' beta)^2) with the gain g of the torque, point 8 */
static sh_real std_deviation(const sh_parameters *p, const sh_combination *found,
                             sh_real attenuated)
{
    return sh_std_deviation(found->variance +
                            sh_square(p->prior.torque_gain * found->value[SH_RIGHT_GAIN]) +
                            sh_square(attenuated));
}

/* tau_e = F' beta, (21), and sigma = dF' beta, (23), with the curve rls.eta_0. Returns how uncertain
 * the stiffness is.
 */
static sh_combination evaluate_at(const sh_regression_state *state, const sh_parameters *p,
                                  const sh_joint_point *at, sh_point *point)
{
    const sh_columns *columns = &state->columns;
    const sh_posterior *posterior = &state->posterior;
    const sh_combination torque =
        sh_posterior_combine(posterior, p->prior.B, at->F, columns->spring);
    const sh_combination stiffness =
        sh_posterior_combine(posterior, p->prior.B, at->dF, columns->spring);
    const sh_real attenuated = attenuation(state, &stiffness);

    point->tau_e = at->tau_nominal + torque.value[SH_RIGHT_Y];
    point->sigma = at->sigma_nominal + stiffness.value[SH_RIGHT_Y];
    point->sigma_std = std_deviation(p, &stiffness, attenuated * point->sigma);
    point->tau_e_std = std_deviation(p, &torque, attenuated * point->tau_e);
    return stiffness;
}

static void evaluate_filtered_regression(const sh_estimator *estimator, const sh_parameters *p,
                                         sh_real phi, sh_real set_point, sh_point *point)
{
    const sh_regression_state *state = &estimator->method.regression;
    const sh_real at_rest[SH_WIDTHS] = {0};
    sh_joint_point at;

    sh_joint_point_at(&at, &state->columns, p, 0, 0, phi, set_point, at_rest);
    (void)evaluate_at(state, p, &at, point);
}

/* ---- report ------------------------------------------------------------------------------- */

/* Sets the coefficients eta, and adds up the coefficients of each kind of column [size: SH_COLUMN_KINDS]. */
static void read_coefficients(const sh_regression_state *state, const sh_parameters *p,
                              const sh_joint_point *at, sh_real *sum, sh_estimate *estimate)
{
    int i, j;

    for (i = 0; i < state->columns.size; ++i) {
        const sh_column *column = &state->columns.column[i];
        const sh_real value = column->prior * state->beta[i];

        if (sh_column_is(column, SH_IS_POWER)) {
            estimate->eta[column->i][column->j] =
                sh_limited(value * column->unit, SH_LARGEST_OUTPUT);
        }
        sum[column->kind] += column->kind == SH_COLUMN_DAMPING
                                 ? value * sh_limited(at->l[column->j], SH_LARGE)
                                 : value;
    }
    for (i = 0; i < p->rls.n && state->columns.has_nominal; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            estimate->eta[i][j] = (p->prior.tau_e > 0 ? estimate->eta[i][j] : 0) +
                                  (1 + sum[SH_COLUMN_NOMINAL]) * p->rls.eta_0[i][j];
        }
    }
}

/* Why the estimate is not confident. The misfit already widens sigma_std, so it has no limit of its own. */
static int doubt_of(const sh_regression_state *state, const sh_parameters *p, const sh_real *sum,
                    const sh_estimate *estimate)
{
    int doubt = SH_DOUBT_NONE;

    if (!(estimate->sigma_std < p->limit.relative_std * sh_fabs(estimate->sigma))) {
        doubt = state->variance_factor > SH_CONTRADICTION ? SH_DOUBT_MISFIT : SH_DOUBT_NOT_EXCITED;
    }
    if (sh_fabs(estimate->phi) > largest_deformation_filtered_regression(p)) {
        doubt = SH_DOUBT_OUT_OF_RANGE;
    }
    if (sh_fabs(sum[SH_COLUMN_VISCOUS]) > SH_OUTSIDE_PRIOR * p->prior.D_theta) {
        doubt = SH_DOUBT_FRICTION;
    }
    if (sh_fabs(sum[SH_COLUMN_INERTIA]) > SH_OUTSIDE_PRIOR * p->prior.B) {
        doubt = SH_DOUBT_INERTIA;
    }
    if (estimate->sigma < 0) {
        doubt = SH_DOUBT_NEGATIVE_STIFFNESS;
    }
    if (sh_change_is_likely(state)) {
        doubt = SH_DOUBT_CHANGE;
    }
    return doubt;
}

/* Sets the outputs that follow from the coefficients and from their combination for the stiffness. */
static void report_coefficients(const sh_regression_state *state, const sh_parameters *p,
                                const sh_joint_point *at, const sh_combination *stiffness,
                                sh_estimate *estimate)
{
    const sh_real K_0 = p->prior.tau_e / p->range.phi, sigma = sh_fabs(estimate->sigma);
    sh_real sum[SH_COLUMN_KINDS] = {0};

    read_coefficients(state, p, at, sum, estimate);
    estimate->sigma_per_gain =
        sigma > 0 ? sh_limited(stiffness->value[SH_RIGHT_GAIN] / sigma, SH_LARGEST_OUTPUT) : 0;
    estimate->D_theta_hat = p->motor.D_theta * (1 + sum[SH_COLUMN_VISCOUS]);
    estimate->B_hat = p->motor.B * (1 + sum[SH_COLUMN_INERTIA]);
    estimate->tau_coulomb_hat = sum[SH_COLUMN_COULOMB];
    estimate->bias_hat = sum[SH_COLUMN_BIAS];
    estimate->damping_hat = sum[SH_COLUMN_DAMPING];
    estimate->load_friction_hat = sum[SH_COLUMN_LOAD] + sum[SH_COLUMN_DRIVE];
    estimate->eccentric_hat =
        K_0 > 0
            ? sh_limited(sh_sqrt(sh_square(sum[SH_COLUMN_SIN_Q]) + sh_square(sum[SH_COLUMN_COS_Q])) / K_0,
                         SH_LARGEST_OUTPUT)
            : 0;
    estimate->delay_hat = sum[SH_COLUMN_DELAY];
    estimate->hysteresis_hat = sum[SH_COLUMN_HYSTERESIS];
    estimate->change_age = state->history.change_age;
    estimate->misfit = sh_sqrt(sh_fmax(1, state->misfit));
    estimate->doubt = doubt_of(state, p, sum, estimate);
}

/* Computes the estimate, and sets all outputs but the innovation. Returns 0, and sets none, if torque or
 * stiffness overflow.
 */
static int report(sh_regression_state *state, const sh_parameters *p, const sh_joint_point *at,
                  sh_real y, sh_real y_fit, sh_estimate *estimate)
{
    const sh_real largest_delay = SH_LARGEST_DELAY * p->prior.delay;
    sh_point point;
    sh_combination stiffness;

    stiffness = evaluate_at(state, p, at, &point);
    if (!isfinite(point.sigma) || !isfinite(point.tau_e) || !isfinite(stiffness.variance) ||
        !isfinite(stiffness.value[SH_RIGHT_GAIN])) {
        return 0;
    }
    estimate->sigma = point.sigma;
    estimate->sigma_std = point.sigma_std;
    estimate->tau_e = point.tau_e;
    estimate->tau_e_std = point.tau_e_std;
    estimate->tau_e_residual = y;
    estimate->phi = at->phi;
    estimate->theta_dot = sh_state_variable_filter_first(&state->signals.filter[SH_FILTER_THETA],
                                                         &state->signals.design);
    report_coefficients(state, p, at, &stiffness, estimate);
    /* What the next row depends on. */
    state->modality = p->modality;
    state->y = y_fit;
    state->sigma = point.sigma;
    state->delay = sh_fmin(sh_fmax(estimate->delay_hat, -largest_delay), largest_delay);
    state->stiffness_known = sh_sqrt(stiffness.variance) < SH_KNOWN_STIFFNESS * point.sigma;
    return 1;
}

/* ---- start -------------------------------------------------------------------------------- */

/* Sets the uncertainty at phi = 0; torque and stiffness there are those of the curve rls.eta_0. */
static void start_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                      sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    sh_joint_point at;
    sh_point point;
    sh_combination stiffness;

    state->modality = p->modality;
    sh_columns_start(&state->columns, p);
    sh_signals_start(&state->signals, &state->history, p);
    sh_information_start(&state->data, state->columns.size, SH_LEAST_INFORMATION);
    sh_blocks_start(state);
    sh_change_start(state);
    state->row.step = SH_ROW_STEPS;
    sh_refit_start(state, p);
    sh_joint_point_at(&at, &state->columns, p, 0, 0, 0, p->setPoint.offset, state->history.stop);
    stiffness = evaluate_at(state, p, &at, &point);
    estimate->sigma_std = point.sigma_std;
    estimate->tau_e_std = point.tau_e_std;
    report_coefficients(state, p, &at, &stiffness, estimate);
}

/* ---- tick --------------------------------------------------------------------------------- */

static sh_real sum_of_squares(const sh_real *x, int size)
{
    sh_real sum = 0;
    int i;

    for (i = 0; i < size; ++i) {
        sum += x[i] * x[i];
    }
    return sum;
}

/* 1 if the signals of a sample are so small that nothing overflows; 0 also if one is not a number. */
static int are_acceptable(const sh_joint_point *at, sh_real y, int size)
{
    return sum_of_squares(at->F, size) <= SH_LARGE && sum_of_squares(at->dF, size) <= SH_LARGE &&
           sh_fabs(at->tau_nominal) <= SH_LARGE && sh_fabs(at->sigma_nominal) <= SH_LARGE &&
           sh_square(y) <= SH_LARGE;
}

/* Whether the filters have settled. */
static int is_settled(sh_history *history, sh_real T)
{
    history->settling = sh_fmax(history->settling - T, 0);
    return !(history->settling > 0);
}

/* Adds the states of the filters to those of the samples before. Returns 1 if a row is complete: then the mean
 * of the states makes it (detail 16).
 */
static int take_sample(sh_regression_state *state, const sh_parameters *p)
{
    const sh_signals *signals = &state->signals;
    const sh_real share = 1 / (sh_real)signals->decimation;
    sh_mean *mean = &state->mean;
    sh_row *row = &state->row;
    int i;

    sh_noise_watch(&state->history, signals, p);
    for (i = 0; i < SH_FILTER_COLUMN + state->columns.size; ++i) {
        sh_state_variable_filter_add(&mean->filter[i], &signals->filter[i], share);
    }
    mean->rough += sh_signals_roughness(signals) * share;
    mean->moved += sh_fabs(signals->theta_before[0] - signals->theta_before[1]) > 0 ? share : 0;
    mean->samples += 1;
    if (mean->samples < signals->decimation) {
        return 0;
    }
    sh_columns_row(state, p, mean->filter, row->x);
    row->rough = mean->rough;
    row->moved = mean->moved;
    (void)memset(mean, 0, sizeof *mean);
    return 1;
}

/* Whether the row shows that the motor was not at rest at the start (detail 12). */
static int has_moved_before(sh_regression_state *state, const sh_parameters *p)
{
    sh_history *history = &state->history;

    if (sh_is_measured(p) || !(history->starting > 0)) {
        return 0;
    }
    history->starting -= (sh_real)state->signals.decimation * p->samplePeriod;
    return sh_noise_contradicts_rest(state, p, state->row.x);
}

/* Weight 1 / R of the row x; 0 if the numbers are too large. */
static sh_real weight_of(const sh_row_noise *noise, const sh_real *x, int size)
{
    const sh_real w = 1 / noise->R;

    return w > 0 && w * sum_of_squares(x, size + SH_RIGHT_SIDES) <= SH_LARGE ? w : 0;
}

/* epsilon = y - x' beta. Its share that is noise of the torque is removed from the column of the
 * motor's torque, which contains this noise too; then epsilon is computed again (detail 14).
 */
static sh_real predict(const sh_regression_state *state, const sh_row_noise *noise, sh_real *x,
                       sh_column_noise *left)
{
    sh_real epsilon = x[state->columns.size + SH_RIGHT_Y];
    int i;

    for (i = 0; i < state->columns.size; ++i) {
        epsilon -= x[i] * state->beta[i];
    }
    return epsilon - sh_columns_remove_noise(state, noise, epsilon, x, left);
}

/* Updates what is noise in columns: of b (detail 7), of the torque (14), and of the spring (point 5). */
static void update_noise(sh_regression_state *state, const sh_parameters *p,
                         const sh_column_noise *left, sh_real w)
{
    sh_posterior *const now = &state->posterior, *const next = &state->refit.posterior;
    const sh_real N = sh_limited(sh_noise_of_inertia(state, p) * w, SH_LARGE);
    sh_real Q;

    state->noise.information += sh_limited(left->information * w, SH_LARGE);
    state->noise.gain += sh_limited(left->gain * w, SH_LARGE);
    state->rounding += sh_limited(sh_noise_of_deformation(&state->signals) * w, SH_LARGE);
    if (!(p->prior.B > 0)) {
        return;
    }
    Q = sh_limited(SH_SPREAD_OF_SQUARE * sh_square(N / p->prior.B), SH_LARGE);
    state->surplus += N;
    state->spread += Q;
    now->spread += Q * now->weight * now->weight;
    next->spread += Q * next->weight * next->weight;
    next->surplus += N * next->weight;
    /* Also without new rounding: what could not be removed before may be removed now. */
    sh_posterior_remove(now, N * now->weight, p->prior.B);
}

/* Takes the row into the estimate. Sets rho, the variance of the prediction over the one of the row. */
static void update(sh_regression_state *state, const sh_parameters *p, const sh_column_noise *left)
{
    const int size = state->columns.size;
    sh_row *row = &state->row;
    const sh_real share =
        sh_posterior_take(&state->posterior, row->x, size, row->w); /* 1 / (1 + rho) */

    row->rho = share > 0 ? sh_limited((1 - share) / share, SH_LARGEST_OUTPUT) : SH_LARGEST_OUTPUT;
    update_noise(state, p, left, row->w);
    sh_posterior_estimate(&state->posterior, p->prior.B, state->beta, size);
    row->step = 0;
}

/* What else a row changes. The steps are of similar length, so that they can be spread evenly: one triangular
 * matrix each, but for the last one, which takes (K + 1) / 2 rows of the data.
 */
static void take_step(sh_regression_state *state, const sh_parameters *p)
{
    sh_row *row = &state->row;
    const sh_real duration = (sh_real)state->signals.decimation * state->signals.design.T;
    sh_real x[SH_MAX_ROW] = {0};

    switch (row->step) {
    case 0: /* before the data: a refit that starts with a step below has this row from them */
        if (!sh_refit_pauses(state)) {
            (void)sh_posterior_take(&state->refit.posterior, row->x, state->columns.size, row->w);
        }
        state->refit.time += duration;
        state->refit.pause += duration;
        break;
    case 1:
        (void)memcpy(x, row->x, sizeof x);
        (void)sh_information_take(&state->data, x, row->w);
        break;
    case 2:
        sh_blocks_take(state);
        sh_blocks_end(state, p, 0);
        break;
    case 3:
    case 4:
    case 5:
        sh_blocks_end(state, p, row->step - 2);
        break;
    default:
        sh_refit_advance(state, p);
        break;
    }
    row->step += 1;
}

/* The steps are spread over the ticks without a new row; all of them follow at once if there is none. */
static void take_steps(sh_regression_state *state, const sh_parameters *p)
{
    const int ticks = state->signals.decimation > 1 ? state->signals.decimation - 1 : 1;
    const int last = state->row.step + (SH_ROW_STEPS + ticks - 1) / ticks;

    while (state->row.step < SH_ROW_STEPS && state->row.step < last) {
        take_step(state, p);
    }
}

/* Waits until the filters have settled. The present block would have rows of before and after it. */
static void wait_until_settled(sh_regression_state *state)
{
    sh_signals_unsettle(&state->signals, &state->history);
    if (state->blocks.rows < state->blocks.length) { /* else it will be taken and emptied */
        sh_blocks_interrupt(&state->blocks);
    }
}

/* After a gap, or a change of the modality, the filters start again. */
static void resume(sh_regression_state *state)
{
    state->signals.begun = 0;
    (void)memset(&state->mean, 0, sizeof state->mean);
    wait_until_settled(state);
}

/* Forgets what the last row depended on: the next one must not be as large because of it. Returns 0. */
static int refuse(sh_regression_state *state, const sh_history *before)
{
    state->signals.begun = 0; /* the filters start again, so their old state does not matter */
    state->history = *before;
    state->sigma = state->delay = state->y = 0;
    state->stiffness_known = 0;
    return 0;
}

/* Takes a complete row. Returns 0 if its numbers are too large. */
static int use_row(sh_regression_state *state, const sh_parameters *p)
{
    sh_row *row = &state->row;
    const sh_row_noise noise = sh_noise_of_row(state, p);
    sh_column_noise left;

    row->w = weight_of(&noise, row->x, state->columns.size); /* 3. Weigh it. */
    row->lasting = noise.lasting;
    if (!(row->w > 0)) {
        return 0;
    }
    row->epsilon = predict(state, &noise, row->x, &left); /* 4. Predict and compare. */
    update(state, p, &left);                              /* 5. Update. */
    return 1;
}

static int tick_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                    const sh_measurement *z, sh_real set_point,
                                    sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    const sh_history before = state->history;
    int settled, complete;
    sh_joint_point at;
    sh_real y;

    if (estimator->started && (estimator->skipped > 0 || state->modality != p->modality)) {
        resume(state);
    }
    if (state->history.change_age >= 0) {
        state->history.change_age += (1 + estimator->skipped) * p->samplePeriod;
    }
    sh_signals_take(state, p, z, set_point, &at); /* 1. Filter the signals. */
    y = sh_columns_y(p, &state->signals.design, state->signals.filter);
    if (!are_acceptable(&at, y, state->columns.size)) {
        return refuse(state, &before);
    }
    settled = is_settled(&state->history, p->samplePeriod);
    complete = settled && take_sample(state, p); /* 2. Build a row of K samples. */
    if (complete && has_moved_before(state, p)) {
        wait_until_settled(state);
        settled = complete = 0;
    }
    if (complete && !use_row(state, p)) { /* 3. to 5. Weigh it, predict it, and update. */
        return refuse(state, &before);
    }
    if (!complete || state->signals.decimation == 1) {
        take_steps(state, p); /* 6. Data, misfit, forgetting, choice of columns. */
    }
    if (!settled) {
        state->row.epsilon = state->row.rho = 0;
    }
    if (!report(state, p, &at, y, y - state->row.epsilon, estimate)) { /* 7. Report. */
        return refuse(state, &before);
    }
    estimate->a = settled ? 1 : 0;
    estimate->rho = state->row.rho;
    estimate->epsilon = state->row.epsilon;
    return 1;
}

const sh_method sh_filtered_regression = {
    .largest_deformation = largest_deformation_filtered_regression,
    .check = check_filtered_regression,
    .start = start_filtered_regression,
    .tick = tick_filtered_regression,
    .evaluate = evaluate_filtered_regression,
};
