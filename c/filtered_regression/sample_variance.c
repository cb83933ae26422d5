#include "sample_variance.h"

#include "columns.h"
#include "posterior.h"
#include "real_math.h"
#include "signals.h"
#include "state_variable_filter.h"

/* Share of the excess of noise after the filter by which samples weigh less. With 0.1 the true
 * stiffness of a stiff joint with jitter is in the interval too rarely, with 1 the interval is too
 * wide.
 */
static const sh_real EXCESS = (sh_real)0.3;

/* Rounding is not white: fourth differences contain 0.944 of what white noise of its variance would
 * have there. Mean over motions of 1 to 100 counts in a sample.
 */
static const sh_real ROUNDING = (sh_real)0.056;

static const sh_real WATCH = (sh_real)0.1; /* time constant of the noise that is measured [s] */
static const sh_real MEAN = 5;             /* time constant of the mean excess [s] */

/* Share of the variance of white noise that the filter leaves: T times the integral of h^2, for the
 * impulse response h of the filter, whose integral is 1.
 */
static sh_real white(const sh_regression_state *state)
{
    return (sh_real)(3.0 / 16) * state->design.w * state->design.T;
}

/* Sum over both encoders [rad2]: rounding of phi has a twelfth of it as its variance. */
static sh_real counts_squared(const sh_regression_state *state)
{
    return sh_square(state->count) + sh_square(state->count_q);
}

/* Variance of the friction whose sign is unknown [(N.m)2]. */
static sh_real friction_variance(sh_regression_state *state, const sh_parameters *p)
{
    sh_posterior *live = &state->live;
    const int C = live->coulomb;
    const sh_real unknown = sh_state_variable_filter_output(&state->unknown);
    sh_real *const c = state->work.own;
    sh_real tau_C;
    int i;

    if (C < 0 || !(sh_fabs(unknown) > 0)) {
        return 0;
    }
    for (i = 0; i < live->information.size; ++i) {
        c[i] = i == C ? 1 : 0;
    }
    tau_C = sh_square(state->beta[live->column[C]]) + sh_posterior_variance(live, c, state->work.v);
    return sh_square(p->motor.gamma * p->prior.tau_coulomb * unknown) * tau_C;
}

/* White noise enters as it is before the filter. A wrong sign of friction in one sample leaves the
 * filter as its impulse response h, in many samples. The mean of these samples is wrong by
 * (sum of h)^2 / (sum of h^2) = 1 / white() times as much as if they were independent, so their
 * variance is multiplied by that.
 *
 * Rounding of phi is white while the joint moves, but the same in all samples while it rests.
 * Friction of unknown sign is the same in all samples while the motor creeps. With R for what is
 * independent and c for what is the same, n samples have the information 1 / (R / n + c): so the
 * n-th sample has the variance R (1 + c n / R)^2.
 */
sh_sample_variance sh_sample_variance_of(sh_regression_state *state, const sh_parameters *p)
{
    const sh_real rounding = sh_square(state->sigma) * counts_squared(state) / 12;
    sh_real R = rounding + sh_square(p->noise.tau_e), stays = rounding * state->history.resting;
    sh_sample_variance variance;

    if (!sh_is_measured(p)) {
        const sh_real friction = friction_variance(state, p);

        R = (rounding + sh_square(p->motor.gamma * p->noise.tau)) *
                (1 + EXCESS * (state->history.excess - 1)) +
            friction / white(state);
        stays += friction * state->history.unsure;
    }
    variance.last = sh_square(1 + stays / R);
    variance.R = R * variance.last;
    return variance;
}

/* Noise of the torque after the filter, behind the gear [(N.m)2]. */
static sh_real torque_noise(const sh_regression_state *state, const sh_parameters *p)
{
    return white(state) * sh_square(p->motor.gamma * p->noise.tau);
}

/* Noise of the inertial torque after the filter by noise of theta [(N.m/rad)2]. */
static sh_real inertial_noise(const sh_regression_state *state, const sh_parameters *p)
{
    return sh_square(sh_square(p->motor.gamma) * p->motor.B) * state->gain_second;
}

sh_real sh_sample_variance_of_torque(const sh_regression_state *state, const sh_parameters *p)
{
    const sh_real theta = sh_fmax(state->history.rough, sh_square(state->count) / 12);
    const sh_real torque = torque_noise(state, p);
    const sh_real sum = torque + inertial_noise(state, p) * theta;

    return sum > 0 ? torque / sum : 0;
}

void sh_sample_variance_watch(sh_regression_state *state, const sh_parameters *p)
{
    const sh_real T = state->design.T;
    const sh_real torque = torque_noise(state, p);
    const sh_real inertial = inertial_noise(state, p);
    const sh_real rounded = torque + inertial * sh_square(state->count) / 12;

    if (sh_is_measured(p)) {
        return;
    }
    state->history.rough +=
        sh_fmin(T / WATCH, 1) * (sh_signals_roughness(state) - state->history.rough);
    state->history.excess = sh_fmax(1, (torque + inertial * state->history.rough) / rounded);
    state->history.excess_mean +=
        sh_fmin(T / MEAN, 1) * (state->history.excess - state->history.excess_mean);
}

sh_real sh_sample_variance_of_deformation(const sh_regression_state *state)
{
    return white(state) * counts_squared(state) / 12;
}

sh_real sh_sample_variance_of_inertia(const sh_regression_state *state, const sh_parameters *p)
{
    const sh_real *theta = state->theta_before;
    const sh_real moved = sh_fabs(theta[0] - theta[1]) > 0 ? 1 : 0;

    if (sh_is_measured(p) || state->live.inertia < 0) {
        return 0;
    }
    return sh_square(sh_square(p->motor.gamma) * p->motor.B * p->prior.B) * state->gain_second *
           (sh_signals_roughness(state) + ROUNDING * moved * sh_square(state->count) / 12);
}

int sh_sample_variance_contradicts_rest(sh_regression_state *state, const sh_parameters *p,
                                        const sh_real *x)
{
    sh_posterior *live = &state->live;
    const sh_real inertial = sh_square(p->motor.gamma) * p->motor.B * state->count;
    sh_real *const own = state->work.own;
    sh_real variance = torque_noise(state, p) + sh_square(inertial) / 12 * state->gain_second +
                       friction_variance(state, p);
    sh_real epsilon = x[state->size + SH_SIDE_Y];
    int i;

    for (i = 0; i < live->information.size; ++i) {
        const int column = live->column[i];

        epsilon -= x[column] * state->beta[column];
        /* A bias, or another thing that the joint may have, would hide a slow motion. If there is
         * one, the estimate waits once in vain.
         */
        own[i] = sh_column_is_of_equation(&state->column[column]) ? x[column] : 0;
    }
    variance += sh_posterior_variance(live, own, state->work.v);
    return sh_square(epsilon) > 25 * variance;
}
