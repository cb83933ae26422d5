/* Method FilteredRegression: one tick, and the outputs of its estimate. */
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
/* Error of phi from encoder harmonics and gear, divided by the once-per-turn error of the link encoder [1]. With 0.025,
 * the estimate of a stiff joint with a free inertia is confident and wrong.
 */
#define SH_HARMONICS ((sh_real)0.035)
/* Largest change of the stiffness by these position errors, in std deviations of the stiffness [1]. */
#define SH_LARGEST_PULL ((sh_real)2)
/* Variance of the squared noise divided by the square of the mean of the squared noise [1]: the noise is correlated. */
#define SH_SPREAD_OF_SQUARE ((sh_real)6)
/* Squared misfit above which the estimate is in doubt, and number of blocks below which this limit holds [1]. With more
 * blocks, most columns that may explain the misfit have been tried, and the variance factor is sufficient.
 */
#define SH_UNEXPLAINED ((sh_real)2.25)
#define SH_UNTRIED_BLOCKS ((sh_real)35)
/* With N blocks, the variance is multiplied by 1 + SH_UNJUDGED_BLOCKS / N [1]. In the first half second, joints with
 * several misfits are then wrong for 1.4 % (without the factor, 4.6 %) of the confident time.
 */
#define SH_UNJUDGED_BLOCKS ((sh_real)10)
/* Limits of x^e and of x for x = |phi| / range.phi and the highest exponent e [1]. Beyond both limits, the estimate is
 * not confident.
 */
#define SH_LARGEST_POWER ((sh_real)32)
#define SH_LEAST_LIMIT ((sh_real)2)
/* Deviation of a motor parameter above which the estimate is in doubt, in std deviations of the prior [1]. */
#define SH_OUTSIDE_PRIOR ((sh_real)3)
/* Distance of viscous friction below 0 from which the estimate is in doubt, in std deviations [1]. Such a friction
 * shows that the encoders are read at different times. Of 40 simulated logs, only the eight with a late encoder had
 * such a friction.
 */
#define SH_BELOW_ZERO ((sh_real)1)

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

/* Returns the |phi| at which the highest power is 32 times its value at range.phi, but at least twice range.phi. */
static sh_real largest_deformation_filtered_regression(const sh_parameters *p)
{
    const int e = sh_power_of_phi(p->rls.symmetric, p->rls.n - 1);

    return p->range.phi * sh_fmax(SH_LEAST_LIMIT, sh_exp(sh_log(SH_LARGEST_POWER) / (sh_real)e));
}

/* ---- torque and stiffness at a point ------------------------------------------------------ */

static sh_variances variances_at(const sh_regression_state *state, const sh_parameters *p,
                                 const sh_joint_point *at)
{
    return sh_posterior_variances(&state->posterior, p->prior.B, at->F, at->dF,
                                  state->columns.spring);
}

/* Returns the variance of torque or stiffness by errors of phi, which make the value too small by the share v sum
 * V_phi/R (point 5). Errors that repeat with the position change the value by at most two std deviations. A larger
 * change would also move coefficients of the motor far from their priors.
 *
 * value     times v sum 1/R
 * variance  of the value
 */
static sh_real of_errors(const sh_regression_state *state, const sh_parameters *p, sh_real value,
                         sh_real variance)
{
    const sh_real harmonics = sh_square(SH_HARMONICS * p->prior.eccentric);

    return sh_square(sh_noise_of_deformation(&state->signals) * value) +
           sh_fmin(sh_square(harmonics * value), sh_square(SH_LARGEST_PULL) * variance);
}

/* tau_e = F' beta, (21), and sigma = dF' beta, (23), with the curve rls.eta_0. Both variances are the sum of c' P c,
 * (s_g d(c' beta)/dg)^2 for the gain g of the torque (point 8), and a term for errors of phi (point 5). The variance of
 * sigma also contains the uncertainty of the slope near a knee [(N.m/rad)2] (point 6). As an approximation, the share
 * by which errors of phi change sigma is also used for the torque. Returns d sigma / dg, which may overflow.
 */
static sh_real evaluate_at(const sh_regression_state *state, const sh_parameters *p,
                           const sh_joint_point *at, const sh_variances *variances, sh_real knees,
                           sh_point *point)
{
    /* v sum 1/R: times V_phi, the share by which sigma is too small */
    const sh_real attenuation =
        state->samples.weights * state->posterior.weight * variances->second;
    const sh_real gain = p->prior.torque_gain;
    const int count = state->columns.spring;
    sh_real torque, torque_per_gain, stiffness, stiffness_per_gain;

    sh_scalar_products(at->F, state->beta, state->per_gain, count, &torque, &torque_per_gain);
    sh_scalar_products(at->dF, state->beta, state->per_gain, count, &stiffness,
                       &stiffness_per_gain);
    point->tau_e = at->tau_nominal + torque;
    point->sigma = at->sigma_nominal + stiffness;
    point->tau_e_std =
        sh_std_deviation(variances->first + sh_square(gain * torque_per_gain) +
                         of_errors(state, p, attenuation * point->tau_e, variances->first));
    point->sigma_std = sh_std_deviation(
        variances->second + sh_square(gain * stiffness_per_gain) +
        of_errors(state, p, attenuation * point->sigma, variances->second) + knees);
    point->sigma_per_gain =
        sh_fabs(point->sigma) > 0
            ? sh_limited(stiffness_per_gain / sh_fabs(point->sigma), SH_LARGEST_OUTPUT)
            : 0;
    return stiffness_per_gain;
}

/* Evaluates torque and stiffness at a constant deformation, without hysteresis. */
static void evaluate_at_rest(const sh_regression_state *state, const sh_parameters *p, sh_real phi,
                             sh_real set_point, sh_joint_point *at, sh_point *point)
{
    const sh_real at_rest[SH_WIDTHS] = {0};
    sh_variances variances;
    sh_real knees;

    sh_joint_point_at(at, &state->columns, p, 0, 0, phi, set_point, at_rest);
    knees = sh_columns_judge_knees(&state->columns, p, state->beta, at);
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

/* Converts the coefficients of powers of s - c to coefficients of powers of the set-point s, by Horner's scheme. */
static void shift_set_point(sh_estimate *estimate, sh_real c)
{
    int i, j, k;

    for (i = 0; i < SH_MAX_N; ++i) {
        for (k = 0; k < SH_MAX_M - 1; ++k) {
            for (j = SH_MAX_M - 2; j >= k; --j) {
                const sh_real shifted = estimate->eta[i][j] - c * estimate->eta[i][j + 1];

                estimate->eta[i][j] = sh_limited(shifted, SH_LARGEST_OUTPUT);
            }
        }
    }
}

/* Sets the coefficients eta, and adds up the coefficients of each kind of column in sum [size: SH_COLUMN_KINDS]. */
static void read_coefficients(const sh_regression_state *state, const sh_parameters *p,
                              const sh_joint_point *at, sh_real *sum, sh_estimate *estimate)
{
    int i, j;

    for (i = 0; i < state->columns.size; ++i) {
        const sh_column *column = &state->columns.column[i];
        sh_real value = column->prior * state->beta[i];

        if (sh_column_is(column, SH_IS_POWER)) {
            estimate->eta[column->i][column->j] =
                sh_limited(value * column->unit, SH_LARGEST_OUTPUT);
        } else if (column->kind == SH_COLUMN_DAMPING) {
            value *= sh_limited(at->l[column->j], SH_LARGE);
        }
        sum[column->kind] += value;
    }
    if (sh_fabs(p->range.setPoint_center) > 0 && p->prior.tau_e > 0) {
        shift_set_point(estimate, p->range.setPoint_center);
    }
    for (i = 0; i < p->rls.n && state->columns.has_nominal; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            estimate->eta[i][j] = (p->prior.tau_e > 0 ? estimate->eta[i][j] : 0) +
                                  (1 + sum[SH_COLUMN_NOMINAL]) * p->rls.eta_0[i][j];
        }
    }
}

/* Returns the reason why the estimate is not confident. The misfit increases sigma_std. For few blocks, the misfit also
 * has a limit of its own, because some columns that may explain the misfit have not been tried. With N blocks, c' P c
 * is multiplied by 1 + 10/N, because few blocks hardly show whether the model holds.
 */
static int doubt_of(const sh_regression_state *state, const sh_parameters *p,
                    const sh_estimate *estimate)
{
    const sh_real phi = sh_fabs(estimate->phi), N = sh_fmax(state->bank.count, 1);
    const sh_real unjudged =
        p->regression.memory > 0 ? state->variances.second * SH_UNJUDGED_BLOCKS / N : 0;
    int doubt = SH_DOUBT_NONE;

    if (!(sh_square(estimate->sigma_std) + unjudged <
          sh_square(p->limit.relative_std * estimate->sigma))) {
        doubt = state->misfit.variance_factor > SH_CONTRADICTION ? SH_DOUBT_MISFIT
                                                                 : SH_DOUBT_NOT_EXCITED;
    }
    if (p->regression.memory > 0 && state->bank.count < SH_UNTRIED_BLOCKS &&
        state->misfit.square > SH_UNEXPLAINED) {
        doubt = SH_DOUBT_MISFIT;
    }
    if (phi > SH_LEAST_LIMIT * p->range.phi && phi > largest_deformation_filtered_regression(p)) {
        doubt = SH_DOUBT_OUT_OF_RANGE;
    }
    if (sh_fabs(state->viscous) > SH_OUTSIDE_PRIOR * p->prior.D_theta ||
        1 + state->viscous < -SH_BELOW_ZERO * state->friction_std) {
        doubt = SH_DOUBT_FRICTION;
    }
    if (sh_fabs(state->inertia) > SH_OUTSIDE_PRIOR * p->prior.B) {
        doubt = SH_DOUBT_INERTIA;
    }
    if (estimate->sigma < 0) {
        doubt = SH_DOUBT_NEGATIVE_STIFFNESS;
    }
    if (sh_bank_doubts(&state->bank) || sh_misfit_is_sudden(&state->misfit)) {
        doubt = SH_DOUBT_CHANGE;
    }
    return doubt;
}

/* Sets the outputs that are computed from the coefficients and from the stiffness in estimate. */
static void report_coefficients(sh_regression_state *state, const sh_parameters *p,
                                const sh_joint_point *at, sh_estimate *estimate)
{
    sh_real sum[SH_COLUMN_KINDS] = {0}, turning;

    read_coefficients(state, p, at, sum, estimate);
    turning = sh_sqrt(sh_square(sum[SH_COLUMN_SIN_Q]) + sh_square(sum[SH_COLUMN_COS_Q]));
    state->viscous = sum[SH_COLUMN_VISCOUS];
    state->inertia = sum[SH_COLUMN_INERTIA];
    estimate->D_theta_hat = p->motor.D_theta * (1 + state->viscous);
    estimate->B_hat = p->motor.B * (1 + state->inertia);
    estimate->tau_coulomb_hat = sum[SH_COLUMN_COULOMB];
    estimate->bias_hat = sum[SH_COLUMN_BIAS];
    estimate->damping_hat = sum[SH_COLUMN_DAMPING];
    estimate->load_friction_hat = sum[SH_COLUMN_LOAD] + sum[SH_COLUMN_DRIVE];
    estimate->eccentric_hat =
        turning > 0 ? turning / sh_fmax(sh_fabs(estimate->sigma), turning) : 0; /* at most 1 rad */
    estimate->delay_hat = sum[SH_COLUMN_DELAY];
    estimate->hysteresis_hat = sum[SH_COLUMN_HYSTERESIS];
}

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

/* Sets all outputs. If a number overflows, returns 0 and sets no output. The variances at a point take as much time as
 * a row, so they are computed once for a row (detail 16).
 *
 * settled  whether the filters have settled
 * news     SH_NEW_*
 */
static int report(sh_regression_state *state, const sh_parameters *p, sh_joint_point *at, sh_real y,
                  int settled, int news, sh_estimate *estimate)
{
    const sh_real knees = sh_columns_judge_knees(&state->columns, p, state->beta, at);
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
    estimate->change_age = state->change_age;
    estimate->misfit = sh_sqrt(state->misfit.square);
    if ((news & SH_NEW_COEFFICIENTS) != 0) {
        report_coefficients(state, p, at, estimate);
    }
    estimate->doubt = doubt_of(state, p, estimate);
    return 1;
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
    sh_signals_start(&state->signals, p);
    sh_samples_start(&state->samples, state->columns.size);
    sh_block_start(&state->block, &state->signals);
    sh_bank_start(&state->bank, state->columns.size);
    sh_misfit_start(&state->misfit, state->columns.size);
    sh_schedule_start(state, p);
    state->change_age = -1;
    evaluate_at_rest(state, p, 0, p->setPoint.offset, &at, &point);
    state->variances = variances_at(state, p, &at);
    estimate->sigma_std = point.sigma_std;
    estimate->tau_e_std = point.tau_e_std;
    report_coefficients(state, p, &at, estimate);
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

/* Adds a sample to the mean of the present row. Returns 1 if the row is complete (detail 16). */
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

/* Updates the sums of noise in the columns of b (detail 7), the torque (detail 14) and the spring (point 5). */
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
    sh_row_predict(row, &state->columns, state->beta, noise, &left); /* 4. Predict and compare. */
    share = sh_posterior_take(&state->posterior, row->x, size, row->w); /* 5. Update. */
    sh_row_compare(row, share);
    update_noise(state, p, &left, row->w);
    sh_schedule_row(&state->schedule);
    return 1;
}

/* Waits until the filters have settled. An incomplete block is dropped, because a block must not contain a gap. */
static void wait_until_settled(sh_regression_state *state)
{
    sh_signals_unsettle(&state->signals);
    if (!sh_block_is_full(&state->block)) { /* else it will be taken and emptied */
        sh_block_empty(&state->block);
    }
}

/* Resets the quantities that made the last row too large, so that the next row is acceptable. Returns 0. */
static int refuse(sh_regression_state *state, const sh_history *before, sh_real age)
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
    const sh_real friction =
        sh_noise_of_friction(&state->signals, &state->columns, &state->posterior, state->beta, p);

    return sh_noise_of_row(&state->signals, &state->feedback, friction, p);
}

/* Detail 12: returns 1 if the newest row shows that the motor was not at rest at the start. */
static int contradicts_rest(sh_regression_state *state, const sh_parameters *p,
                            const sh_row_noise *noise)
{
    sh_signals *signals = &state->signals;

    if (sh_is_measured(p) || !(signals->history.starting > 0)) {
        return 0;
    }
    sh_signals_pass_start(signals, (sh_real)signals->decimation * p->samplePeriod);
    return sh_noise_contradicts_rest(signals, &state->columns, &state->posterior, state->beta,
                                     state->row.x, noise, p);
}

static int tick_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                    const sh_measurement *z, sh_real set_point,
                                    sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    const sh_history before = state->signals.history;
    const sh_real age = state->change_age;
    int settled, complete, news;
    sh_joint_point at;
    sh_real y;

    if (estimator->started && (estimator->skipped > 0 || state->modality != p->modality)) {
        sh_signals_begin_anew(&state->signals);
        wait_until_settled(state);
    }
    if (state->change_age >= 0) {
        state->change_age += (1 + estimator->skipped) * p->samplePeriod;
    }
    /* 1. Filter the signals. */
    if (sh_signals_take(&state->signals, &state->columns, state->beta, &state->feedback, p, z,
                        set_point, &at)) {
        sh_mean_empty(&state->mean);
    }
    y = sh_columns_y(p, &at.filtered);
    if (!are_acceptable(&at, y, &state->columns)) {
        return refuse(state, &before, age);
    }
    settled = sh_signals_settle(&state->signals, p->samplePeriod);
    complete = settled && take_sample(state, p, &at.filtered); /* 2. Build a row of K samples. */
    if (complete) {
        const sh_row_noise noise = noise_of_row(state, p);

        if (contradicts_rest(state, p, &noise)) {
            wait_until_settled(state);
            settled = 0;
        } else if (!use_row(state, p, &noise)) { /* 3. to 5. Weigh it, predict it, and update. */
            return refuse(state, &before, age);
        }
    }
    /* The variances are computed at each tick until the first row is complete, also after a gap. */
    news = complete || (settled && state->row.w > 0) ? 0 : SH_NEW_VARIANCES;
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
    .largest_deformation = largest_deformation_filtered_regression,
    .check = check_filtered_regression,
    .start = start_filtered_regression,
    .tick = tick_filtered_regression,
    .evaluate = evaluate_filtered_regression,
};
