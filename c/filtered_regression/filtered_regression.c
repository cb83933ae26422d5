/* Method FilteredRegression: the tick. */
#include "information.h"
#include "method.h"
#include "pair.h"
#include "real_math.h"
#include "regression.h"
#include "state_variable_filter.h"

/* Relative std deviation of sigma below which the columns that are computed from sigma are used [1]. */
#define SH_KNOWN_STIFFNESS ((sh_real)0.2)
/* Largest delay that the column of the delay corrects, in std deviations of the delay's prior [1]. */
#define SH_LARGEST_DELAY ((sh_real)3)
/* Variance of the squared noise divided by the square of the mean of the squared noise [1]: the noise is correlated. */
#define SH_SPREAD_OF_SQUARE ((sh_real)6)

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

/* ---- torque and stiffness at a point ------------------------------------------------------ */

static sh_variances variances_at(const sh_regression_state *state, const sh_parameters *p,
                                 const sh_joint_point *at)
{
    return sh_posterior_variances(&state->posterior, p->prior.B, at->F, at->dF,
                                  state->columns.spring);
}

/* Evaluates torque and stiffness, where knees make the slope uncertain by a variance [(N.m/rad)2]. Returns
 * d sigma / dg, which may overflow.
 */
static sh_real evaluate_at(const sh_regression_state *state, const sh_parameters *p,
                           const sh_joint_point *at, const sh_variances *variances, sh_real knees,
                           sh_point *point)
{
    sh_phi_errors errors;

    errors.weights = state->samples.weights * state->posterior.weight;
    errors.rounding = sh_noise_of_deformation(&state->signals);
    errors.knees = knees;
    return sh_point_evaluate(point, &state->coefficients, p, at, state->columns.spring, variances,
                             &errors);
}

/* Evaluates torque and stiffness at a constant deformation, without hysteresis. */
static void evaluate_at_rest(const sh_regression_state *state, const sh_parameters *p, sh_real phi,
                             sh_real set_point, sh_joint_point *at, sh_point *point)
{
    const sh_real at_rest[SH_WIDTHS] = {0};
    sh_variances variances;
    sh_real knees;

    sh_joint_point_at(at, &state->columns, p, 0, 0, phi, set_point, at_rest);
    knees = sh_columns_judge_knees(&state->columns, p, state->coefficients.beta, at);
    variances = variances_at(state, p, at);
    (void)evaluate_at(state, p, at, &variances, knees, point);
}

static void evaluate_filtered_regression(const sh_estimator *estimator, const sh_parameters *p,
                                         sh_real phi, sh_real set_point, sh_point *point)
{
    sh_joint_point at;

    evaluate_at_rest(&estimator->method.regression, p, phi, set_point, &at, point);
}

/* ---- report ------------------------------------------------------------------------------- */

/* Returns what the next row needs of the estimate, whose y is y [N.m]. */
static sh_feedback feedback_of(const sh_estimate *estimate, const sh_parameters *p, sh_real y,
                               sh_real variance_of_sigma)
{
    sh_feedback feedback;

    feedback.y = y - estimate->epsilon;
    feedback.sigma = estimate->sigma;
    feedback.delay = sh_limited(estimate->delay_hat, SH_LARGEST_DELAY * p->prior.delay);
    feedback.stiffness_known = sh_sqrt(variance_of_sigma) < SH_KNOWN_STIFFNESS * estimate->sigma;
    return feedback;
}

static int doubt_of(const sh_regression_state *state, const sh_parameters *p,
                    const sh_estimate *estimate)
{
    return sh_report_doubt(estimate, &state->coefficients, state->variances.second, &state->bank,
                           &state->misfit, p);
}

/* Sets all outputs. If a number overflows, returns 0 and sets no output. The variances at a point take as much time as
 * a row, so they are computed once for a row (section 15).
 *
 * settled  whether the filters have settled
 * news     SH_NEW_*
 */
static int report(sh_regression_state *state, const sh_parameters *p, sh_joint_point *at, sh_real y,
                  int settled, int news, sh_estimate *estimate)
{
    const sh_real knees = sh_columns_judge_knees(&state->columns, p, state->coefficients.beta, at);
    sh_point point;
    sh_real per_gain;

    if ((news & SH_NEW_VARIANCES) != 0) {
        state->variances = variances_at(state, p, at);
    }
    per_gain = evaluate_at(state, p, at, &state->variances, knees, &point);
    if (!isfinite(point.sigma) || !isfinite(point.tau_e) || !isfinite(state->variances.second) ||
        !isfinite(per_gain)) {
        return 0;
    }
    estimate->sigma = point.sigma;
    estimate->sigma_std = point.sigma_std;
    estimate->tau_e = point.tau_e;
    estimate->tau_e_std = point.tau_e_std;
    estimate->sigma_per_gain = point.sigma_per_gain;
    estimate->tau_e_residual = y;
    estimate->phi = at->phi;
    estimate->theta_dot = at->filtered.first[SH_FILTER_THETA];
    estimate->a = settled ? 1 : 0;
    estimate->rho = state->row.rho;
    estimate->epsilon = state->row.epsilon;
    estimate->change_age =
        state->change_age < 0 ? -1 : (sh_real)state->change_age * p->samplePeriod;
    estimate->misfit = sh_sqrt(state->misfit.square);
    if ((news & SH_NEW_COEFFICIENTS) != 0) {
        sh_report_coefficients(&state->columns, &state->coefficients, p, at, estimate);
    }
    estimate->doubt = doubt_of(state, p, estimate);
    return 1;
}

/* Starts all that a row changes. */
static void start_learning(sh_regression_state *state, const sh_parameters *p)
{
    const sh_feedback nothing = {0, 0, 0, 0};

    sh_row_start(&state->row, &state->mean);
    sh_samples_start(&state->samples, state->columns.size);
    sh_block_empty(&state->block);
    sh_bank_start(&state->bank, state->columns.size);
    sh_misfit_start(&state->misfit);
    sh_coefficients_start(&state->coefficients, p);
    sh_schedule_start(state, p);
    state->feedback = nothing;
    state->change_age = -1;
}

/* Starts the state, and sets the uncertainty of the start estimate, which is the curve rls.eta_0, at phi = 0. */
static void start_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                      sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    sh_joint_point at;
    sh_point point;

    state->modality = p->modality;
    sh_columns_start(&state->columns, p);
    sh_gate_start(&state->gate, &state->columns, p);
    sh_signals_start(&state->signals, p);
    sh_rest_start(&state->rest, &state->signals.design);
    sh_block_start(&state->block, &state->signals);
    start_learning(state, p);
    evaluate_at_rest(state, p, 0, p->setPoint.offset, &at, &point);
    state->variances = variances_at(state, p, &at);
    estimate->sigma_std = point.sigma_std;
    estimate->tau_e_std = point.tau_e_std;
    sh_report_coefficients(&state->columns, &state->coefficients, p, &at, estimate);
    estimate->misfit = sh_sqrt(state->misfit.square);
    estimate->doubt = doubt_of(state, p, estimate);
}

/* ---- tick --------------------------------------------------------------------------------- */

/* Returns 1 if the signals of a sample are finite numbers and so small that no computation overflows. */
static int are_acceptable(const sh_joint_point *at, sh_real y, const sh_columns *columns)
{
    return sh_sum_of_products(at->F, at->F, columns->filtered) <= SH_LARGE &&
           sh_sum_of_products(at->dF, at->dF, columns->spring) <= SH_LARGE &&
           sh_fabs(at->tau_nominal) <= SH_LARGE && sh_fabs(at->sigma_nominal) <= SH_LARGE &&
           sh_square(at->phi) <= SH_LARGE && sh_square(at->phi_set) <= SH_LARGE &&
           sh_square(y) <= SH_LARGE;
}

/* (F30): returns 1 if a joint can give the sample. Otherwise, the estimate is in doubt. */
static int passes_gate(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                       sh_real set_point, sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;

    if (state->modality != p->modality) { /* the torque is another quantity */
        sh_gate_start(&state->gate, &state->columns, p);
    }
    if (!sh_gate_take(&state->gate, p, z, set_point, estimator->skipped)) {
        estimate->doubt = SH_DOUBT_OUTLIER;
        estimate->confident = 0;
        return 0;
    }
    return 1;
}

/* Adds a sample to the mean of the present row. Returns 1 if the row is complete (section 4). */
static int take_sample(sh_regression_state *state, const sh_parameters *p, const sh_filtered *now)
{
    const sh_real rough = sh_signals_watch_theta(&state->signals, p);
    const int complete = sh_row_add(&state->row, &state->mean, &state->signals, &state->columns,
                                    &state->feedback, p, now, rough);

    if (complete) {
        sh_signals_rest(&state->signals, state->columns.filtered);
    }
    return complete;
}

/* Updates the sums of noise in the columns of b (F12), the torque (F15) and the spring (F25). */
static void update_noise(sh_regression_state *state, const sh_parameters *p,
                         const sh_column_noise *left, sh_real w)
{
    const int is_uncertain = p->prior.B > 0;
    sh_real N = sh_limited(sh_noise_of_inertia(&state->signals, &state->row, p) * w, SH_LARGE),
            Q = 0;

    if (is_uncertain) {
        Q = sh_limited(SH_SPREAD_OF_SQUARE * sh_square(N / p->prior.B), SH_LARGE);
    } else {
        N = 0;
    }
    sh_samples_count_noise(&state->samples, left, w, N, Q);
    sh_posterior_count_noise(&state->posterior, N, Q);
    sh_posterior_count_noise(&state->refit.posterior, N, Q);
    if (is_uncertain) { /* also if N is 0: noise of earlier rows may not have been removed completely */
        sh_posterior_remove(&state->posterior, p->prior.B);
    }
}

/* Updates the posterior with a complete row: steps 3 to 5 of the tick. Returns 0 if the row is too large. */
static int use_row(sh_regression_state *state, const sh_parameters *p, const sh_row_noise *noise)
{
    const int size = state->columns.size;
    sh_row *row = &state->row;
    sh_column_noise left;
    sh_real share; /* 1 / (1 + rho) */

    if (!sh_row_weigh(row, noise, size)) { /* 3. Weigh it. */
        return 0;
    }
    sh_row_predict(row, &state->columns, state->coefficients.beta, noise,
                   &left); /* 4. Predict and compare. */
    share = sh_posterior_take(&state->posterior, row->x, size, row->w); /* 5. Update. */
    sh_row_compare(row, share);
    update_noise(state, p, &left, row->w);
    sh_schedule_row(&state->schedule);
    return 1;
}

/* Waits until the filters have settled. The rows before the gap belong to no block, because a block must not contain a
 * gap.
 */
static void wait_until_settled(sh_regression_state *state)
{
    sh_signals_unsettle(&state->signals);
    sh_block_empty(&state->block);
    sh_schedule_interrupt(&state->schedule);
}

/* Resets the quantities that made the last row too large, so that the next row is acceptable. Returns 0. */
static int refuse(sh_regression_state *state, const sh_history *before, int age)
{
    const sh_feedback nothing = {0, 0, 0, 0};

    sh_signals_begin_anew(&state->signals); /* so the old state of the filters does not matter */
    sh_signals_restore(&state->signals, before);
    state->change_age = age;
    state->feedback = nothing;
    return 0;
}

static sh_row_noise noise_of_row(const sh_regression_state *state, const sh_parameters *p)
{
    const sh_real friction = sh_noise_of_friction(&state->signals, &state->columns,
                                                  &state->posterior, state->coefficients.beta, p);

    return sh_noise_of_row(&state->signals, &state->feedback, friction, p);
}

/* Section 13: a motor that moved at the first sample makes all rows of the start wrong, and so does a gap before the
 * positions have shown that it was at rest. What was learned is then dropped. Returns SH_NEW_*.
 */
static int learn_anew(sh_regression_state *state, const sh_parameters *p)
{
    sh_rest_end(&state->rest);
    start_learning(state, p);
    wait_until_settled(state);
    return SH_NEW_COEFFICIENTS;
}

/* Starts the filters anew after a gap. Returns SH_NEW_*. */
static int begin_anew(sh_regression_state *state, const sh_parameters *p)
{
    sh_signals_begin_anew(&state->signals);
    if (sh_rest_is_open(&state->rest)) {
        return learn_anew(state, p);
    }
    wait_until_settled(state);
    return 0;
}

/* Tests whether the motor was at rest at the first sample. A measured torque needs no such assumption. Returns SH_NEW_*.
 */
static int test_rest(sh_regression_state *state, const sh_parameters *p, sh_real theta)
{
    const sh_signals *signals = &state->signals;

    if (sh_is_measured(p)) {
        sh_rest_end(&state->rest);
        return 0;
    }
    return sh_rest_take(&state->rest, theta, signals->count, signals->history.rough)
               ? learn_anew(state, p)
               : 0;
}

/* Returns the age of a change, -1 for none, after a number of ticks. A sum of times would not grow any more in float. */
static int older(int age, int ticks)
{
    if (age < 0) {
        return age;
    }
    return age < SH_MOST_TICKS - ticks ? age + ticks : SH_MOST_TICKS;
}

static int tick_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                    const sh_measurement *z, sh_real set_point,
                                    sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    const sh_history before = state->signals.history;
    const int age = state->change_age;
    int settled, complete, news = 0;
    sh_joint_point at;
    sh_real y;

    if (!passes_gate(estimator, p, z, set_point, estimate)) {
        return 0;
    }
    if (estimator->started && (estimator->skipped > 0 || state->modality != p->modality)) {
        news |= begin_anew(state, p);
    }
    state->change_age = older(state->change_age, 1 + estimator->skipped);
    /* 1. Filter the signals. */
    if (sh_signals_take(&state->signals, &state->columns, state->coefficients.beta,
                        &state->feedback, p, z, set_point, &at)) {
        sh_mean_empty(&state->mean);
    }
    y = sh_columns_y(p, &at.filtered);
    if (!are_acceptable(&at, y, &state->columns)) {
        return refuse(state, &before, age);
    }
    news |= test_rest(state, p, z->theta);
    settled = sh_signals_settle(&state->signals, p->samplePeriod);
    complete = settled && take_sample(state, p, &at.filtered); /* 2. Build a row of K samples. */
    if (complete) {
        const sh_row_noise noise = noise_of_row(state, p);

        if (!use_row(state, p, &noise)) { /* 3. to 5. Weigh it, predict it, and update. */
            return refuse(state, &before, age);
        }
    }
    /* The variances are computed at each tick before the first row, and after a gap until the filters have settled. */
    news |= complete || (settled && state->row.w > 0) ? 0 : SH_NEW_VARIANCES;
    if (!complete || state->signals.decimation == 1) {
        news |= sh_schedule_advance(state, p); /* 6. Estimate, data, misfit, choice of columns. */
    }
    if (!settled) {
        sh_row_drop_prediction(&state->row);
    }
    if (!report(state, p, &at, y, settled, news, estimate)) { /* 7. */
        return refuse(state, &before, age);
    }
    state->modality = p->modality;
    state->feedback = feedback_of(estimate, p, y, state->variances.second);
    return 1;
}

const sh_method sh_filtered_regression = {
    .largest_deformation = sh_largest_deformation,
    .check = check_filtered_regression,
    .start = start_filtered_regression,
    .tick = tick_filtered_regression,
    .evaluate = evaluate_filtered_regression,
};
