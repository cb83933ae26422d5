/* The filters: all signals of the regression pass the same H. */
#include "constants.h"
#include "method.h"
#include "regression.h"
#include "state_variable_filter.h"

/* W_c = sqrt(s_tau / (B |gamma| s_n)), s_n = count / sqrt(12), is where the noise of the torque and the
 * rounding of theta contribute equally to y; point 1.
 */
sh_real sh_regression_bandwidth(const sh_parameters *p)
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

/* K = 2.5 / (w T), 1..8: rows of more samples would lose what the filter leaves. */
int sh_regression_decimation(const sh_parameters *p)
{
    const sh_real wT = sh_regression_bandwidth(p) * p->samplePeriod;
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
    signals->design = sh_state_variable_filter_design(sh_regression_bandwidth(p), p->samplePeriod);
    signals->decimation = sh_regression_decimation(p);
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

/* The deformation of a sample: its range, hysteresis, and how long it rests. */
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

/* The first sample. The motor is assumed to be at rest, at any torque: theta starts at its value, and
 * the signals of the equation start from zero, because the equation holds from now on (detail 12).
 */
static void begin_filters(sh_regression_state *state, const sh_parameters *p,
                          const sh_joint_point *at, sh_real torque)
{
    sh_signals *signals = &state->signals;
    sh_state_variable_filter *filter = signals->filter;
    const sh_real turned = p->motor.gamma * at->theta;
    int i;

    sh_state_variable_filter_start(&filter[SH_FILTER_THETA], at->theta, at->theta);
    sh_state_variable_filter_start(&filter[SH_FILTER_PHI], at->phi, at->phi);
    sh_state_variable_filter_start(&filter[SH_FILTER_PHI_SET], at->phi_set, at->phi_set);
    sh_state_variable_filter_start(&filter[SH_FILTER_SIN_M], sh_sin(turned), sh_sin(turned));
    sh_state_variable_filter_start(&filter[SH_FILTER_COS_M], sh_cos(turned), sh_cos(turned));
    sh_state_variable_filter_start(&filter[SH_FILTER_TORQUE], torque, 0);
    sh_state_variable_filter_start(&filter[SH_FILTER_NOMINAL], at->tau_nominal, 0);
    sh_state_variable_filter_start(&filter[SH_FILTER_SIGN], 0, 0);
    sh_state_variable_filter_start(&filter[SH_FILTER_UNKNOWN], 0, 0);
    sh_state_variable_filter_start(&filter[SH_FILTER_LOAD], 0, 0);
    for (i = 0; i < state->columns.filtered; ++i) {
        sh_column_filters_start(&signals->columns, state->mean.output, i, at->F[i], 0);
    }
    sh_motion_sign_start(&signals->motion, at->theta);
    for (i = 0; i < 5; ++i) {
        signals->theta_before[i] = at->theta;
    }
    signals->begun = 1;
}

static void advance_measured(sh_signals *signals, const sh_parameters *p, sh_real theta,
                             sh_real torque)
{
    const sh_filter_design *design = &signals->design;
    sh_state_variable_filter *filter = signals->filter;
    int i;

    for (i = 4; i > 0; --i) {
        signals->theta_before[i] = signals->theta_before[i - 1];
    }
    signals->theta_before[0] = theta;
    sh_state_variable_filter_step(&filter[SH_FILTER_THETA], design, theta);
    if (p->torque.held && !sh_is_measured(p)) {
        sh_state_variable_filter_step_mean(&filter[SH_FILTER_TORQUE], design,
                                           signals->torque_before);
    } else {
        sh_state_variable_filter_step(&filter[SH_FILTER_TORQUE], design, torque);
    }
    sh_motion_sign_step(&signals->motion, theta, signals->count, p->regression.slow * design->T);
    sh_state_variable_filter_step_mean(&filter[SH_FILTER_SIGN], design, signals->motion.sign);
    sh_state_variable_filter_step_mean(&filter[SH_FILTER_UNKNOWN], design, signals->motion.unknown);
}

/* Signals that begin as if they had been so before: those of the damping, and of the motor's encoder. */
static void advance_steady(sh_signals *signals, const sh_parameters *p, const sh_joint_point *at)
{
    const sh_filter_design *design = &signals->design;
    sh_state_variable_filter *filter = signals->filter;

    if (p->prior.damping > 0) {
        sh_state_variable_filter_step(&filter[SH_FILTER_PHI], design, at->phi);
        sh_state_variable_filter_step(&filter[SH_FILTER_PHI_SET], design, at->phi_set);
    }
    if (p->prior.eccentric_motor > 0) {
        const sh_real turned = p->motor.gamma * at->theta;

        sh_state_variable_filter_step(&filter[SH_FILTER_SIN_M], design, sh_sin(turned));
        sh_state_variable_filter_step(&filter[SH_FILTER_COS_M], design, sh_cos(turned));
    }
}

/* The friction by load acts against the motion. Before the stiffness is known, the load is taken from
 * the motor data: it is the last fitted y (detail 13).
 */
static void advance_load(sh_regression_state *state, const sh_joint_point *at)
{
    sh_signals *signals = &state->signals;
    const sh_real load =
        state->stiffness_known ? sh_columns_torque(&state->columns, at, state->beta) : state->y;

    sh_state_variable_filter_step_mean(&signals->filter[SH_FILTER_LOAD], &signals->design,
                                       -sh_fabs(load) * signals->motion.sign);
}

void sh_signals_take(sh_regression_state *state, const sh_parameters *p, const sh_measurement *z,
                     sh_real set_point, sh_joint_point *at)
{
    sh_signals *signals = &state->signals;
    const sh_real phi = z->q - z->theta, torque = sh_regression_torque(p, z, z->tau);

    take_deformation(&state->history, signals, p, phi);
    sh_joint_point_at(at, &state->columns, p, z->theta, z->q, phi, set_point, state->history.stop);
    if (signals->begun) {
        advance_measured(signals, p, at->theta, torque);
        if (state->columns.has_nominal) {
            sh_state_variable_filter_step(&signals->filter[SH_FILTER_NOMINAL], &signals->design,
                                          at->tau_nominal);
        }
        state->history.unsure = signals->motion.unknown > 0 ? state->history.unsure + 1 : 0;
        advance_load(state, at);
        advance_steady(signals, p, at);
        sh_column_filters_step(&signals->columns, state->mean.output, &signals->design, at->F,
                               state->columns.filtered);
    } else {
        begin_filters(state, p, at, torque);
    }
    signals->torque_before = torque;
}

/* The fourth difference of white noise of variance 1 has the variance 70. */
sh_real sh_signals_roughness(const sh_signals *signals)
{
    const sh_real *theta = signals->theta_before;

    return sh_square(theta[0] - 4 * theta[1] + 6 * theta[2] - 4 * theta[3] + theta[4]) / 70;
}
