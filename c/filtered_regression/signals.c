#include "signals.h"

#include "columns.h"
#include "method.h"
#include "motion_sign.h"
#include "real_math.h"
#include "state_variable_filter.h"

sh_real sh_regression_bandwidth(const sh_parameters *p)
{
    const sh_real count = sh_encoder_count(p->encoder.theta);
    const sh_real rounding = p->motor.B * sh_fabs(p->motor.gamma) * count / sh_sqrt(12);

    if (sh_is_measured(p) || !(rounding > 0)) {
        return p->regression.bandwidth;
    }
    return sh_fmax(
        sh_fmin(p->regression.bandwidth, (sh_real)1.42 * sh_sqrt(p->noise.tau / rounding)),
        (sh_real)1e-4 / p->samplePeriod);
}

void sh_signals_start(sh_regression_state *state, const sh_parameters *p)
{
    state->modality = p->modality;
    state->count = sh_encoder_count(p->encoder.theta);
    state->count_q = sh_encoder_count(p->encoder.q);
    state->design = sh_state_variable_filter_design(sh_regression_bandwidth(p), p->samplePeriod);
    state->gain_second = sh_state_variable_filter_noise(&state->design);
    state->history.starting = SH_FORGOTTEN / state->design.w;
    state->history.excess = state->history.excess_mean = 1;
    state->history.phi_min = SH_LARGE; /* no deformation yet */
    state->history.phi_max = -SH_LARGE;
}

void sh_signals_unsettle(sh_regression_state *state)
{
    state->history.starting = 0;
    state->history.settling = SH_FORGOTTEN / state->design.w;
}

void sh_signals_resume(sh_regression_state *state)
{
    state->begun = 0;
    sh_signals_unsettle(state);
}

void sh_signals_deform(sh_regression_state *state, const sh_parameters *p, sh_real phi)
{
    sh_history *history = &state->history;
    const sh_real change = state->begun ? phi - history->phi : 0;
    const sh_real least = sh_fmin(state->count, state->count_q) / 4;

    sh_columns_move_plays(state, p, change);
    history->phi_min = sh_fmin(history->phi_min, phi);
    history->phi_max = sh_fmax(history->phi_max, phi);
    history->resting = sh_fabs(change) > least ? 0 : history->resting + 1;
    history->phi = phi;
}

/* The first sample of the filters. They assume a motor at rest, at any torque. So theta starts at
 * its value, and the signals of the equation start from zero: the equation holds from now on.
 */
static void begin_all(sh_regression_state *state, sh_real theta, sh_real torque)
{
    int i;

    sh_state_variable_filter_start(&state->theta, theta);
    sh_state_variable_filter_begin(&state->torque, torque);
    sh_state_variable_filter_begin(&state->nominal, state->tau_nominal);
    sh_state_variable_filter_start(&state->friction, 0);
    sh_state_variable_filter_start(&state->unknown, 0);
    for (i = 0; i < state->size; ++i) {
        const int signal = sh_column_signal(&state->column[i]);

        if (signal == SH_SIGNAL_LINEAR) {
            sh_state_variable_filter_begin(&state->filter[i], state->work.F[i]);
        } else {
            sh_state_variable_filter_start(&state->filter[i], state->work.F[i]);
        }
    }
    sh_motion_sign_start(&state->motion, theta);
    for (i = 0; i < 5; ++i) {
        state->theta_before[i] = theta;
    }
    state->begun = 1;
}

/* Friction that a load adds acts against the motion: its signal is the mean over the sample. */
static sh_real load_friction(const sh_regression_state *state)
{
    /* Before the stiffness is known, the torque of the spring is taken from the motor data. */
    const sh_real tau_e = state->stiffness_known ? sh_columns_torque(state) : state->y;

    return -sh_fabs(tau_e) * state->motion.sign;
}

static void advance_columns(sh_regression_state *state)
{
    const sh_filter_design *design = &state->design;
    int i;

    for (i = 0; i < state->size; ++i) {
        const int signal = sh_column_signal(&state->column[i]);

        if (signal == SH_SIGNAL_MEAN) {
            sh_state_variable_filter_step_mean(&state->filter[i], design,
                                               load_friction(state) * state->column[i].prior);
        } else if (signal != SH_SIGNAL_NONE) {
            sh_state_variable_filter_step(&state->filter[i], design, state->work.F[i]);
        }
    }
}

static void advance_all(sh_regression_state *state, const sh_parameters *p, sh_real theta,
                        sh_real torque)
{
    const sh_filter_design *design = &state->design;
    int i;

    for (i = 4; i > 0; --i) {
        state->theta_before[i] = state->theta_before[i - 1];
    }
    state->theta_before[0] = theta;
    sh_state_variable_filter_step(&state->theta, design, theta);
    if (p->torque.held && !sh_is_measured(p)) {
        sh_state_variable_filter_step_mean(&state->torque, design, state->torque_before);
    } else {
        sh_state_variable_filter_step(&state->torque, design, torque);
    }
    if (state->has_nominal) {
        sh_state_variable_filter_step(&state->nominal, design, state->tau_nominal);
    }
    sh_motion_sign_step(&state->motion, theta, state->count, p->regression.slow * design->T);
    state->history.unsure = state->motion.unknown > 0 ? state->history.unsure + 1 : 0;
    sh_state_variable_filter_step_mean(&state->friction, design, state->motion.sign);
    sh_state_variable_filter_step_mean(&state->unknown, design, state->motion.unknown);
    advance_columns(state);
}

void sh_signals_step(sh_regression_state *state, const sh_parameters *p, sh_real theta,
                     sh_real torque)
{
    if (state->begun) {
        advance_all(state, p, theta, torque);
    } else {
        begin_all(state, theta, torque);
    }
    state->torque_before = torque;
}

sh_real sh_signals_roughness(const sh_regression_state *state)
{
    const sh_real *theta = state->theta_before;
    const sh_real fourth = theta[0] - 4 * theta[1] + 6 * theta[2] - 4 * theta[3] + theta[4];

    return fourth * fourth / 70;
}
