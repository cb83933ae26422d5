/* The filters: all signals of the regression pass the same H. */
#include "method.h"
#include "real_math.h"
#include "regression.h"
#include "state_variable_filter.h"

/* Largest corner frequency divided by W_c of (F6) [1]. Above 2, the noise of y is not white. */
#define SH_LARGEST_CORNER ((sh_real)1.42)
/* Change of phi in a sample, divided by the finer encoder resolution, below which phi counts as constant [1]. */
#define SH_RESTS ((sh_real)0.25)
/* Spacing of the rows divided by 1/w, and largest number of samples of a row [1]. The spacing 1.8 has the same results,
 * and the spacing 4.5 has 2 % larger errors. With 16 samples, a log of 10 s at 250 Hz has too few blocks.
 */
#define SH_ROW_SPACING ((sh_real)2.5)
#define SH_LONGEST_ROW 8
/* Time constant of the measured noise [s]. */
#define SH_NOISE_TIME ((sh_real)0.1)

/* At W_c = sqrt(s_tau / (B |gamma| s_n)), s_n = count / sqrt(12), the noise of the torque and the rounding of theta
 * contribute equally to y (F6). The filter is designed only for w T >= 1e-4.
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

/* Returns the number of samples of a row, K = 2.5 / (w T), 1..8 (F8). Longer rows would lose information. */
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

void sh_signals_start(sh_signals *signals, const sh_parameters *p)
{
    sh_history *history = &signals->history;

    signals->count = sh_encoder_count(p->encoder.theta);
    signals->count_q = sh_encoder_count(p->encoder.q);
    signals->design = sh_state_variable_filter_design(bandwidth_of(p), p->samplePeriod);
    signals->decimation = decimation_of(p);
    sh_state_variable_filter_noise(&signals->design, 1, signals->decimation, &signals->gain,
                                   &signals->gain_second);
    signals->gain /= (sh_real)signals->decimation; /* of a mean of K samples */
    signals->gain_second /= (sh_real)signals->decimation;
    history->phi_min = SH_LARGE; /* no deformation yet */
    history->phi_max = -SH_LARGE;
}

void sh_signals_unsettle(sh_signals *signals)
{
    signals->history.settling = SH_FORGOTTEN / signals->design.w;
}

/* Updates the history by the deformation of a sample: range, hysteresis, and number of samples without a change. */
static void take_deformation(sh_signals *signals, const sh_parameters *p, sh_real phi)
{
    sh_history *history = &signals->history;
    const sh_real change = signals->begun ? phi - history->phi : 0;
    const sh_real least = SH_RESTS * sh_fmin(signals->count, signals->count_q);

    sh_columns_move_stops(history->stop, p, change);
    history->phi_min = sh_fmin(history->phi_min, phi);
    history->phi_max = sh_fmax(history->phi_max, phi);
    history->resting = sh_fabs(change) > least ? 0 : history->resting + 1;
    history->phi = phi;
}

/* Returns the load that causes friction: the spring torque, or the last fitted y without a known stiffness (section 1).
 */
static sh_real load_of(const sh_columns *columns, const sh_real *beta, const sh_feedback *feedback,
                       const sh_joint_point *at)
{
    return feedback->stiffness_known
               ? at->tau_nominal + sh_sum_of_products(at->F, beta, columns->spring)
               : feedback->y;
}

/* Sets the inputs of the filters [size: SH_FILTERS]: values at the sample, or means since the last sample. */
static void set_inputs(const sh_motion_sign *motion, const sh_parameters *p,
                       const sh_joint_point *at, sh_real torque, sh_real load, sh_real *x)
{
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
    x[SH_FILTER_LOAD] = -sh_fabs(load) * motion->sign;
}

/* Starts the filters at the first sample. The motor is assumed to be at rest, at any torque (section 13), so the filter
 * of theta starts at the present position. The signals of the equation of motion start at zero.
 */
static void begin_filters(sh_signals *signals, const sh_columns *columns, const sh_parameters *p,
                          const sh_joint_point *at, sh_real torque, sh_real load)
{
    sh_real x[SH_FILTERS];
    int i;

    sh_motion_sign_start(&signals->motion, at->theta);
    set_inputs(&signals->motion, p, at, torque, load, x);
    for (i = 0; i < SH_FILTERS; ++i) {
        sh_filters_start(&signals->filters, i, x[i], i < SH_FILTER_NOMINAL ? x[i] : 0);
    }
    for (i = 0; i < columns->filtered; ++i) {
        sh_filters_start(&signals->filters, SH_FILTERS + i, at->F[i], 0);
    }
    for (i = 0; i < 5; ++i) {
        signals->theta_before[i] = at->theta;
    }
    signals->begun = 1;
}

static void advance_filters(sh_signals *signals, const sh_columns *columns, const sh_parameters *p,
                            const sh_joint_point *at, sh_real torque, sh_real load)
{
    const int held = p->torque.held && !sh_is_measured(p);
    sh_real x[SH_FILTERS];
    int i;

    for (i = 4; i > 0; --i) {
        signals->theta_before[i] = signals->theta_before[i - 1];
    }
    signals->theta_before[0] = at->theta;
    sh_motion_sign_step(&signals->motion, at->theta, signals->count,
                        p->regression.slow * p->samplePeriod);
    signals->history.unsure = signals->motion.unknown > 0 ? signals->history.unsure + 1 : 0;
    set_inputs(&signals->motion, p, at, held ? signals->torque_before : torque, load, x);
    for (i = held ? SH_FILTER_TORQUE : SH_FILTER_SIGN; i < SH_FILTERS; ++i) {
        sh_filters_hold(&signals->filters, i, x[i]);
    }
    sh_filters_step(&signals->filters, &signals->design, 0, x, SH_FILTERS);
    sh_filters_step(&signals->filters, &signals->design, SH_FILTERS, at->F, columns->filtered);
}

int sh_signals_take(sh_signals *signals, const sh_columns *columns, const sh_real *beta,
                    const sh_feedback *feedback, const sh_parameters *p, const sh_measurement *z,
                    sh_real set_point, sh_joint_point *at)
{
    const sh_real phi = z->q - z->theta, torque = sh_regression_torque(p, z, z->tau);
    const int begin = !signals->begun;
    sh_real load;

    take_deformation(signals, p, phi);
    sh_joint_point_at(at, columns, p, z->theta, z->q, phi, set_point, signals->history.stop);
    load = load_of(columns, beta, feedback, at);
    if (begin) {
        begin_filters(signals, columns, p, at, torque, load);
    } else {
        advance_filters(signals, columns, p, at, torque, load);
    }
    signals->torque_before = torque;
    sh_filters_read(&signals->filters, &signals->design, &at->filtered);
    return begin;
}

void sh_signals_begin_anew(sh_signals *signals)
{
    signals->begun = 0;
}

void sh_signals_restore(sh_signals *signals, const sh_history *history)
{
    signals->history = *history;
}

void sh_signals_rest(sh_signals *signals, int filtered)
{
    sh_filters_rest(&signals->filters, SH_FILTERS + filtered);
}

/* The fourth difference of white noise of variance 1 has the variance 70; section 5 */
sh_real sh_signals_watch_theta(sh_signals *signals, const sh_parameters *p)
{
    const sh_real *theta = signals->theta_before;
    const sh_real rough =
        sh_square(theta[0] - 4 * theta[1] + 6 * theta[2] - 4 * theta[3] + theta[4]) / 70;
    sh_real *mean = &signals->history.rough;

    if (!sh_is_measured(p)) {
        *mean += sh_fmin(p->samplePeriod / SH_NOISE_TIME, 1) * (rough - *mean);
    }
    return rough;
}
