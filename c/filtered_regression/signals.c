/* The filters: all signals of the regression pass the same H. */
#include <string.h>

#include "constants.h"
#include "method.h"
#include "regression.h"
#include "state_variable_filter.h"

/* At W_c = sqrt(s_tau / (B |gamma| s_n)), s_n = count / sqrt(12), the noise of the torque and the rounding of theta
 * contribute equally to y (point 1). The filter is designed only for w T >= 1e-4.
 */
static sh_real bandwidth_of(const sh_parameters *p)
{
    const sh_real s_n = sh_encoder_count(p->encoder.theta) / sh_sqrt(12);
    const sh_real rounding = p->motor.B * sh_fabs(p->motor.gamma) * s_n;

    if (sh_is_measured(p) || !(rounding > 0)) {
        return p->regression.bandwidth;
    }
    return sh_fmax(
        sh_fmin(p->regression.bandwidth, SH_LARGEST_CORNER * sh_sqrt(p->noise.tau / rounding)),
        (sh_real)1e-4 / p->samplePeriod);
}

/* Returns the number of samples of a row, K = 2.5 / (w T), 1..8. Longer rows would lose information. */
static int decimation_of(const sh_parameters *p)
{
    const sh_real wT = bandwidth_of(p) * p->samplePeriod;
    int K = SH_LONGEST_ROW;

    if (p->regression.decimation > 0) {
        return p->regression.decimation;
    }
    while (K > 1 && (sh_real)K * wT > SH_ROW_SPACING) {
        K -= 1;
    }
    return K;
}

void sh_signals_start(sh_signals *signals, sh_history *history, const sh_parameters *p)
{
    signals->count = sh_encoder_count(p->encoder.theta);
    signals->count_q = sh_encoder_count(p->encoder.q);
    signals->design = sh_state_variable_filter_design(bandwidth_of(p), p->samplePeriod);
    signals->decimation = decimation_of(p);
    sh_state_variable_filter_noise(&signals->design, 1, signals->decimation, &signals->gain,
                                   &signals->gain_second);
    signals->gain /= (sh_real)signals->decimation; /* of a mean of K samples */
    signals->gain_second /= (sh_real)signals->decimation;
    history->starting = SH_FORGOTTEN / signals->design.w;
    history->phi_min = SH_LARGE; /* no deformation yet */
    history->phi_max = -SH_LARGE;
}

void sh_signals_unsettle(sh_signals *signals, sh_history *history)
{
    history->starting = 0;
    history->settling = SH_FORGOTTEN / signals->design.w;
}

/* Updates the history by the deformation of a sample: range, hysteresis, and number of samples without a change. */
static void take_deformation(sh_history *history, const sh_signals *signals, const sh_parameters *p,
                             sh_real phi)
{
    const sh_real change = signals->begun ? phi - history->phi : 0;
    const sh_real least = SH_RESTS * sh_fmin(signals->count, signals->count_q);

    sh_columns_move_stops(history->stop, p, change);
    history->phi_min = sh_fmin(history->phi_min, phi);
    history->phi_max = sh_fmax(history->phi_max, phi);
    history->resting = sh_fabs(change) > least ? 0 : history->resting + 1;
    history->phi = phi;
}

/* Returns the load that causes friction: the spring torque, or the last fitted y without a known stiffness (detail 13).
 */
static sh_real load_of(const sh_regression_state *state, const sh_joint_point *at)
{
    return state->stiffness_known
               ? at->tau_nominal + sh_sum_of_products(at->F, state->beta, state->columns.spring)
               : state->y;
}

/* Sets the inputs of the filters [size: SH_FILTERS]: values at the sample, or means since the last sample. */
static void set_inputs(const sh_regression_state *state, const sh_parameters *p,
                       const sh_joint_point *at, sh_real torque, sh_real *x)
{
    const sh_motion_sign *motion = &state->signals.motion;
    const int turns = p->prior.eccentric_motor > 0;
    const sh_real turned = p->motor.gamma * at->theta;

    x[SH_FILTER_THETA] = at->theta;
    x[SH_FILTER_PHI] = at->phi;
    x[SH_FILTER_PHI_SET] = at->phi_set;
    x[SH_FILTER_SIN_M] = turns ? sh_sin(turned) : 0;
    x[SH_FILTER_COS_M] = turns ? sh_cos(turned) : 0;
    x[SH_FILTER_NOMINAL] = at->tau_nominal;
    x[SH_FILTER_TORQUE] = torque;
    x[SH_FILTER_SIGN] = motion->sign;
    x[SH_FILTER_UNKNOWN] = motion->unknown;
    x[SH_FILTER_LOAD] = -sh_fabs(load_of(state, at)) * motion->sign;
}

/* Starts the filters at the first sample. The motor is assumed to be at rest, at any torque (detail 12), so the filter
 * of theta starts at the present position. The signals of the equation of motion start at zero.
 */
static void begin_filters(sh_regression_state *state, const sh_parameters *p,
                          const sh_joint_point *at, sh_real torque)
{
    sh_signals *signals = &state->signals;
    sh_real x[SH_FILTERS];
    int i;

    sh_motion_sign_start(&signals->motion, at->theta);
    set_inputs(state, p, at, torque, x);
    for (i = 0; i < SH_FILTERS; ++i) {
        sh_filters_start(&signals->filters, i, x[i], i < SH_FILTER_NOMINAL ? x[i] : 0);
    }
    for (i = 0; i < state->columns.filtered; ++i) {
        sh_filters_start(&signals->filters, SH_FILTERS + i, at->F[i], 0);
    }
    for (i = 0; i < 5; ++i) {
        signals->theta_before[i] = at->theta;
    }
    (void)memset(&state->mean, 0, sizeof state->mean);
    signals->begun = 1;
}

static void advance_filters(sh_regression_state *state, const sh_parameters *p,
                            const sh_joint_point *at, sh_real torque)
{
    sh_signals *signals = &state->signals;
    const int held = p->torque.held && !sh_is_measured(p);
    sh_real x[SH_FILTERS];
    int i;

    for (i = 4; i > 0; --i) {
        signals->theta_before[i] = signals->theta_before[i - 1];
    }
    signals->theta_before[0] = at->theta;
    sh_motion_sign_step(&signals->motion, at->theta, signals->count,
                        p->regression.slow * p->samplePeriod);
    state->history.unsure = signals->motion.unknown > 0 ? state->history.unsure + 1 : 0;
    set_inputs(state, p, at, held ? signals->torque_before : torque, x);
    for (i = held ? SH_FILTER_TORQUE : SH_FILTER_SIGN; i < SH_FILTERS; ++i) {
        sh_filters_hold(&signals->filters, i, x[i]);
    }
    sh_filters_step(&signals->filters, &signals->design, 0, x, SH_FILTERS);
    sh_filters_step(&signals->filters, &signals->design, SH_FILTERS, at->F,
                    state->columns.filtered);
}

void sh_signals_take(sh_regression_state *state, const sh_parameters *p, const sh_measurement *z,
                     sh_real set_point, sh_joint_point *at)
{
    const sh_real phi = z->q - z->theta, torque = sh_regression_torque(p, z, z->tau);

    take_deformation(&state->history, &state->signals, p, phi);
    sh_joint_point_at(at, &state->columns, p, z->theta, z->q, phi, set_point, state->history.stop);
    if (state->signals.begun) {
        advance_filters(state, p, at, torque);
    } else {
        begin_filters(state, p, at, torque);
    }
    state->signals.torque_before = torque;
    sh_filters_read(&state->signals.filters, &state->signals.design, &at->filtered);
}
