/* Method FilteredRegression: one tick, and what its estimate means. The regression is that of columns.h.
 */
#include <stddef.h>

#include "blocks.h"
#include "columns.h"
#include "information.h"
#include "method.h"
#include "passes.h"
#include "posterior.h"
#include "real_math.h"
#include "sample_variance.h"
#include "scaled_basis.h"
#include "signals.h"
#include "state_variable_filter.h"

/* Relative uncertainty of the stiffness below which columns that need it have an effect. */
static const sh_real KNOWN = (sh_real)0.2;

/* Where the highest power of the curve is this many times as large as at range.phi, nothing is
 * claimed. But up to LEAST_LIMIT range.phi, something is.
 */
static const sh_real LARGEST_POWER = 32, LEAST_LIMIT = 2;

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

static sh_real largest_deformation_filtered_regression(const sh_parameters *p)
{
    const int highest = sh_scaled_basis_power(p->rls.symmetric, p->rls.n - 1);

    return p->range.phi * sh_fmax(LEAST_LIMIT, sh_exp(sh_log(LARGEST_POWER) / (sh_real)highest));
}

/* ---- what the estimate means ------------------------------------------------------------- */

/* Coefficients of the columns, in the units of their priors. */
typedef struct {
    sh_real nominal, viscous, inertia, coulomb; /* relative errors; friction [N.m] */
    sh_real bias, damping, sin_q, cos_q, load, delay, plays, unused;
} joint_coefficients;

/* Where the coefficient of a kind that has one column is returned. */
static sh_real *coefficient_of(joint_coefficients *joint, int kind)
{
    switch (kind) {
    case SH_COLUMN_NOMINAL:
        return &joint->nominal;
    case SH_COLUMN_BIAS:
        return &joint->bias;
    case SH_COLUMN_SIN_Q:
        return &joint->sin_q;
    case SH_COLUMN_COS_Q:
        return &joint->cos_q;
    case SH_COLUMN_DELAY:
        return &joint->delay;
    case SH_COLUMN_VISCOUS:
        return &joint->viscous;
    case SH_COLUMN_COULOMB:
        return &joint->coulomb;
    case SH_COLUMN_INERTIA:
        return &joint->inertia;
    default:
        return &joint->unused;
    }
}

/* Sets the coefficients eta of setPoint^j phi^e in the estimate, and returns those of all columns
 * that are not products of powers.
 */
static joint_coefficients read_columns(const sh_regression_state *state, const sh_parameters *p,
                                       sh_real set_point, sh_estimate *estimate)
{
    const sh_real l = set_point / p->range.setPoint;
    joint_coefficients joint = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    int i;

    for (i = 0; i < state->size; ++i) {
        const sh_column *column = &state->column[i];
        const sh_real value = column->prior * state->beta[i];
        const sh_real coefficient = sh_limited(value * column->unit, SH_LARGEST_OUTPUT);

        switch (column->kind) {
        case SH_COLUMN_BASIS:
        case SH_COLUMN_POWER:
        case SH_COLUMN_SET_POWER:
            estimate->eta[column->index / SH_MAX_M][column->index % SH_MAX_M] = coefficient;
            break;
        case SH_COLUMN_DAMPING:
            joint.damping += value * sh_limited(sh_power(l, column->index), SH_LARGE);
            break;
        case SH_COLUMN_LOAD:
        case SH_COLUMN_DRIVE: /* both torques are nearly the same where the motion is slow */
            joint.load += value;
            break;
        case SH_COLUMN_PLAY_1:
        case SH_COLUMN_PLAY_2:
        case SH_COLUMN_PLAY_3:
            joint.plays += value;
            break;
        default:
            *coefficient_of(&joint, column->kind) = value;
            break;
        }
    }
    return joint;
}

/* Adds the curve rls.eta_0, whose relative error is `error`. Without one, and without columns of the
 * basis, the coefficients stay 0.
 */
static void add_nominal_curve(const sh_regression_state *state, const sh_parameters *p,
                              sh_real error, sh_estimate *estimate)
{
    const int is_basis = p->prior.tau_e > 0;
    int i, j;

    if (!state->has_nominal) {
        return;
    }
    for (i = 0; i < p->rls.n; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            estimate->eta[i][j] =
                (is_basis ? estimate->eta[i][j] : 0) + (1 + error) * p->rls.eta_0[i][j];
        }
    }
}

static void report_joint(const sh_regression_state *state, const sh_parameters *p,
                         const joint_coefficients *joint, sh_estimate *estimate)
{
    const sh_real stiffness = p->prior.tau_e / p->range.phi;

    estimate->D_theta_hat = p->motor.D_theta * (1 + joint->viscous);
    estimate->B_hat = p->motor.B * (1 + joint->inertia);
    estimate->tau_coulomb_hat = joint->coulomb;
    estimate->bias_hat = joint->bias;
    estimate->damping_hat = joint->damping;
    estimate->load_friction_hat = joint->load;
    estimate->eccentric_hat =
        stiffness > 0
            ? sh_limited(sh_sqrt(joint->sin_q * joint->sin_q + joint->cos_q * joint->cos_q) /
                             stiffness,
                         SH_LARGEST_OUTPUT)
            : 0;
    estimate->delay_hat = joint->delay;
    estimate->hysteresis_hat = joint->plays;
    estimate->misfit = sh_sqrt(sh_fmax(1, state->q));
}

/* Why the estimate is not confident. Misfit and priors make sigma_std right; so there is no limit of
 * the misfit itself.
 */
static int doubt_of(const sh_regression_state *state, const sh_parameters *p,
                    const joint_coefficients *joint, const sh_estimate *estimate)
{
    int doubt = SH_DOUBT_NONE;

    if (!(estimate->sigma_std < p->limit.relative_std * sh_fabs(estimate->sigma))) {
        doubt = state->variance_factor > SH_CONTRADICTION ? SH_DOUBT_MISFIT : SH_DOUBT_NOT_EXCITED;
    }
    if (sh_fabs(estimate->phi) > state->largest_deformation) {
        doubt = SH_DOUBT_OUT_OF_RANGE;
    }
    if (sh_fabs(joint->viscous) > 3 * p->prior.D_theta) {
        doubt = SH_DOUBT_FRICTION;
    }
    if (sh_fabs(joint->inertia) > 3 * p->prior.B) {
        doubt = SH_DOUBT_INERTIA;
    }
    if (estimate->sigma < 0) {
        doubt = SH_DOUBT_NEGATIVE_STIFFNESS;
    }
    return doubt;
}

/* Share by which the rounding of phi reduces sigma, to first order, if the spring has the slope of
 * this instant in all samples. sigma is not corrected by it: slopes differ, and rounding is not
 * quite white. It widens the interval.
 */
static sh_real attenuation(const sh_regression_state *state, const sh_stiffness_fit *fit)
{
    return state->rounding * state->live.weight * fit->variance;
}

/* Sets all that follows from the fit. */
static void report(const sh_regression_state *state, const sh_parameters *p, sh_real set_point,
                   const sh_stiffness_fit *fit, sh_estimate *estimate)
{
    const sh_real by_gain = p->prior.torque_gain * fit->by_gain;
    joint_coefficients joint;

    const sh_real by_rounding = attenuation(state, fit) * estimate->sigma;

    estimate->sigma_std =
        sh_std_deviation(fit->variance + by_gain * by_gain + by_rounding * by_rounding);
    estimate->sigma_per_gain =
        sh_fabs(estimate->sigma) > 0
            ? sh_limited(fit->by_gain / sh_fabs(estimate->sigma), SH_LARGEST_OUTPUT)
            : 0;
    joint = read_columns(state, p, set_point, estimate);
    add_nominal_curve(state, p, joint.nominal, estimate);
    report_joint(state, p, &joint, estimate);
    estimate->doubt = doubt_of(state, p, &joint, estimate);
}

/* ---- start and tick ---------------------------------------------------------------------- */

static void start_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                      sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    sh_stiffness_fit fit;

    state->largest_deformation = largest_deformation_filtered_regression(p);
    sh_signals_start(state, p);
    sh_columns_start(state, p);
    sh_information_start(&state->data, state->size, SH_INFORMATION_LEAST);
    sh_blocks_start(state);
    sh_posterior_start(state, p, &state->live, 0, 1);
    sh_passes_start(state, p);
    sh_columns_input(state, p, 0, 0, 0, p->setPoint.offset);
    fit = sh_posterior_evaluate(state, &state->live);
    report(state, p, p->setPoint.offset, &fit, estimate);
}

static sh_real sum_of_squares(const sh_real *x, int size)
{
    sh_real sum = 0;
    int i;

    for (i = 0; i < size; ++i) {
        sum += x[i] * x[i];
    }
    return sum;
}

/* Whether torque and stiffness do not overflow at the signals in work. */
static int are_acceptable_signals(const sh_regression_state *state)
{
    return sum_of_squares(state->work.F, state->size) <= SH_LARGE &&
           sum_of_squares(state->work.dF, state->size) <= SH_LARGE &&
           sh_fabs(state->tau_nominal) <= SH_LARGE && sh_fabs(state->sigma_nominal) <= SH_LARGE;
}

/* As the outputs of the same names. */
typedef struct {
    sh_real a, rho, epsilon;
} innovation_of_sample;

/* Learns from the row x in work, whose sum of squares is `size2`. Sets what follows from the
 * prediction. Returns 0 if the numbers are too large.
 */
static int learn(sh_regression_state *state, const sh_parameters *p, sh_real size2,
                 innovation_of_sample *innovation)
{
    sh_real *const x = state->work.x, *const row = state->work.row;
    sh_sample_variance variance;
    sh_real w, epsilon, rounding, share;
    int i;

    sh_sample_variance_watch(state, p);
    variance = sh_sample_variance_of(state, p);
    w = 1 / variance.R;
    if (!(w > 0) || !(w * size2 <= SH_LARGE)) {
        return 0;
    }
    state->R = variance.R;
    epsilon = x[state->size + SH_SIDE_Y];
    for (i = 0; i < state->size; ++i) {
        epsilon -= x[i] * state->beta[i];
    }
    epsilon -=
        sh_columns_remove_noise(state, p, sh_sample_variance_of_torque(state, p) * epsilon, x);
    share = sh_posterior_take(state, &state->live, x, w, row);
    innovation->a = 1;
    innovation->rho =
        share > 0 ? sh_limited((1 - share) / share, SH_LARGEST_OUTPUT) : SH_LARGEST_OUTPUT;
    innovation->epsilon = epsilon;

    state->rounding += sh_limited(sh_sample_variance_of_deformation(state) * w, SH_LARGE);
    rounding = sh_limited(sh_sample_variance_of_inertia(state, p) * w, SH_LARGE);
    if (state->live.inertia >= 0) { /* what could not be removed before may be removed now */
        /* 6: variance of the square of a noise that is correlated from sample to sample. The
         * removal acts on b over prior.B, see sh_posterior_remove.
         */
        const sh_real by_removal = rounding / p->prior.B;
        const sh_real spread = sh_limited(6 * by_removal * by_removal, SH_LARGE);
        sh_posterior *const both[] = {&state->live, &state->build};

        state->surplus += rounding;
        state->spread += spread;
        for (i = 0; i < 2; ++i) {
            both[i]->spread += spread * both[i]->weight * both[i]->weight;
        }
        state->build.surplus += rounding * state->build.weight;
        sh_posterior_remove(&state->live, rounding * state->live.weight, p->prior.B);
    }
    for (i = 0; i < state->size + SH_SIDES; ++i) {
        row[i] = x[i];
    }
    (void)sh_information_take(&state->data, row, w);
    sh_blocks_take(state, p, x, w, variance.last);
    sh_passes_step(state, p, x, w);
    return 1;
}

/* Whether the estimate may learn from this sample: the filters have settled, and at the start the
 * motor was at rest.
 */
static int is_settled(sh_regression_state *state, const sh_parameters *p)
{
    state->history.settling = sh_fmax(state->history.settling - p->samplePeriod, 0);
    if (state->history.settling > 0) {
        return 0;
    }
    if (sh_is_measured(p) || !(state->history.starting > 0)) {
        return 1;
    }
    state->history.starting -= p->samplePeriod;
    if (!sh_sample_variance_contradicts_rest(state, p, state->work.x)) {
        return 1;
    }
    sh_signals_unsettle(state);
    return 0;
}

static int tick_filtered_regression(sh_estimator *estimator, const sh_parameters *p,
                                    const sh_measurement *z, sh_real set_point,
                                    sh_estimate *estimate)
{
    sh_regression_state *state = &estimator->method.regression;
    const sh_real phi = z->q - z->theta;
    const sh_history before = state->history;
    innovation_of_sample innovation = {0, 0, 0};
    sh_stiffness_fit fit = {0, 0};
    sh_real y, size2, sigma;
    int good, i;

    if (estimator->started && (estimator->skipped > 0 || state->modality != p->modality)) {
        sh_signals_resume(state);
        sh_blocks_interrupt(&state->blocks, state->size);
    }
    sh_signals_deform(state, p, phi);
    sh_columns_input(state, p, z->theta, z->q, phi, set_point);
    sh_signals_step(state, p, z->theta, sh_regression_torque(p, z, z->tau));
    y = sh_columns_row(state, p, state->work.x);
    size2 = sum_of_squares(state->work.x, state->size + SH_SIDES);
    good = are_acceptable_signals(state) && size2 <= SH_LARGE; /* false if not a number */
    if (good && is_settled(state, p)) {
        good = learn(state, p, size2, &innovation);
    }
    if (good) {
        fit = sh_posterior_evaluate(state, &state->live);
    }
    sigma = state->sigma_nominal;
    for (i = 0; i < state->size; ++i) {
        sigma += state->work.dF[i] * state->beta[i];
    }
    if (!good || !isfinite(sigma) || !isfinite(fit.variance) || !isfinite(fit.by_gain)) {
        state->begun = 0; /* the filters start again, so their old state does not matter */
        state->history = before;
        /* The next row must not be as large as this one because of what the last one left. */
        state->sigma = state->delay = state->y = 0;
        state->stiffness_known = 0;
        return 0;
    }
    state->modality = p->modality;
    state->y = y;
    state->sigma = sigma;
    state->stiffness_known = sh_sqrt(fit.variance) < KNOWN * sigma;
    estimate->sigma = sigma;
    estimate->tau_e = sh_columns_torque(state);
    estimate->tau_e_residual = y;
    estimate->phi = phi;
    estimate->theta_dot = sh_state_variable_filter_first(&state->theta, &state->design);
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    report(state, p, set_point, &fit, estimate);
    state->delay = sh_fmin(sh_fmax(estimate->delay_hat, -3 * p->prior.delay), 3 * p->prior.delay);
    return 1;
}

const sh_method sh_filtered_regression = {
    .largest_deformation = largest_deformation_filtered_regression,
    .check = check_filtered_regression,
    .start = start_filtered_regression,
    .tick = tick_filtered_regression,
};
