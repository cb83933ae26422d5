#include "matched_regression.h"

#include <string.h>

#include "real_math.h"

/* Time constants 1/w after which a filter has forgotten. */
static const sh_real FORGOTTEN = 12;

static sh_real square(sh_real x)
{
    return x * x;
}

/* Prior variance of coefficient i of the torque [(N.m)2]. */
static sh_real prior_variance(const sh_matched_regression *matched,
                              const sh_matched_settings *settings, int i)
{
    return square(settings->torque) + square(settings->nominal * matched->eta_0[i]);
}

void sh_matched_start(sh_matched_regression *matched, sh_least_squares *rls,
                      const sh_matched_settings *settings, int basis, const sh_real *eta_0)
{
    sh_real prior_mean[SH_MAX_PARAMETERS] = {0}, curve[SH_MAX_PARAMETERS] = {0};
    int i;

    memset(matched, 0, sizeof *matched);
    matched->basis = basis;
    matched->design = sh_state_variable_filter_design(settings->bandwidth, settings->T);
    matched->rounding = sh_state_variable_filter_noise(&matched->design);
    matched->starting = FORGOTTEN / settings->bandwidth;
    for (i = 0; i < basis; ++i) {
        matched->eta_0[i] = eta_0[i];
        prior_mean[i] = eta_0[i];
        curve[i] = eta_0[i];
    }
    sh_least_squares_start(rls, basis + SH_MAX_MOTOR, prior_mean, square(settings->torque));
    for (i = 0; i < SH_MAX_MOTOR; ++i)
        sh_least_squares_prior(rls, basis + i, square(settings->motor_prior[i]));
    sh_least_squares_widen(rls, square(settings->nominal), curve);
}

void sh_matched_resume(sh_matched_regression *matched, const sh_matched_settings *settings)
{
    matched->begun = 0;
    matched->starting = 0;
    matched->settling = FORGOTTEN / settings->bandwidth;
}

/* Filters begin. The motor is taken to be at rest, at any torque: equations hold from now on. */
static void begin_filters(sh_matched_regression *matched, sh_real theta, sh_real torque,
                          const sh_real *F)
{
    int i;

    sh_state_variable_filter_start(&matched->theta, theta);
    sh_state_variable_filter_begin(&matched->torque, torque);
    sh_state_variable_filter_start(&matched->friction, 0);
    sh_state_variable_filter_start(&matched->unknown, 0);
    for (i = 0; i < matched->basis; ++i)
        sh_state_variable_filter_begin(&matched->column[i], F[i]);
    sh_motion_sign_start(&matched->motion, theta);
}

static void filter(sh_matched_regression *matched, const sh_matched_settings *settings,
                   sh_real theta, sh_real torque, const sh_real *F)
{
    const sh_filter_design *design = &matched->design;
    int i;

    sh_state_variable_filter_step(&matched->theta, design, theta);
    sh_state_variable_filter_step(&matched->torque, design, torque);
    for (i = 0; i < matched->basis; ++i)
        sh_state_variable_filter_step(&matched->column[i], design, F[i]);
    sh_motion_sign_step(&matched->motion, theta, settings->count, settings->slow * settings->T);
    matched->unsure = matched->motion.unknown > 0 ? matched->unsure + 1 : 0;
    sh_state_variable_filter_step_mean(&matched->friction, design, matched->motion.sign);
    sh_state_variable_filter_step_mean(&matched->unknown, design, matched->motion.unknown);
}

/* A filtered signal that is linear (or known) between samples beside signals that are smooth. The
 * filter takes the smooth ones to be linear too, which costs them (Omega T)^2 / 12 at Omega;
 * here the same is taken from the other one.
 */
static sh_real beside_smooth(const sh_state_variable_filter *filter, const sh_filter_design *design)
{
    return sh_state_variable_filter_output(filter) +
           square(design->T) / 12 * sh_state_variable_filter_second(filter, design);
}

/* The regression: columns F [size: basis + SH_MAX_MOTOR], returns y. */
static sh_real regression(const sh_matched_regression *matched, const sh_matched_settings *settings,
                          sh_real *F)
{
    const sh_motor_parameters *motor = &settings->motor;
    const sh_filter_design *design = &matched->design;
    const sh_real viscous = square(motor->gamma) * motor->D_theta *
                            sh_state_variable_filter_first(&matched->theta, design);
    const sh_real inertial =
        square(motor->gamma) * motor->B * sh_state_variable_filter_second(&matched->theta, design);
    sh_real *error = F + matched->basis;
    int i;

    for (i = 0; i < matched->basis; ++i)
        F[i] = sh_state_variable_filter_output(&matched->column[i]);
    for (i = 0; i < SH_MAX_MOTOR; ++i)
        error[i] = 0;
    if (settings->measured)
        return sh_state_variable_filter_output(&matched->torque);
    error[SH_MOTOR_D_THETA] = -viscous;
    error[SH_MOTOR_B] = -inertial;
    error[SH_MOTOR_COULOMB] = -sh_fabs(motor->gamma) * beside_smooth(&matched->friction, design);
    return inertial + viscous - motor->gamma * beside_smooth(&matched->torque, design);
}

/* What the filter leaves of the variance of white noise, as a share: the integral of h^2 for its
 * impulse response h, of which the integral is 1, times T.
 */
static sh_real white(const sh_matched_settings *settings)
{
    return (sh_real)(3.0 / 16) * settings->bandwidth * settings->T;
}

/* Variance of friction whose sign is not known [(N.m)2]. */
static sh_real friction_variance(const sh_matched_regression *matched, const sh_least_squares *rls,
                                 const sh_matched_settings *settings)
{
    const int at = matched->basis + SH_MOTOR_COULOMB;
    const sh_real tau_C = square(rls->eta[at]) + sh_least_squares_covariance(rls, at, at);

    return square(settings->motor.gamma) * tau_C *
           square(sh_state_variable_filter_output(&matched->unknown));
}

/* Variance of a sample beside others that are white [(N.m)2]: of the noise of the torque, of the
 * rounding of phi, of friction.
 *
 * A wrong sign of friction in one sample comes out of the filter as its impulse response h, alike in
 * many samples. What it does to a mean over them is (sum of h)^2 / (sum of h^2) = 1 / white()
 * times what it would do if they were independent, so it counts so many times.
 *
 * Rounding is white while phi moves, but at rest the same in every sample; the sign of friction is
 * wrong for as long as the motor creeps. With R the variance of one sample and c that of its part
 * that stays, n samples tell 1 / (R / n + c). So the last of them tells as much as one with the
 * variance R (1 + c n / R)^2, and all no more than 1 / c.
 */
static sh_real noise_variance(const sh_matched_regression *matched, const sh_least_squares *rls,
                              const sh_matched_settings *settings, sh_real sigma)
{
    const sh_real rounding =
        square(sigma) * (square(settings->count) + square(settings->count_q)) / 12;
    const sh_real gamma = settings->motor.gamma;
    sh_real R = rounding + square(settings->noise), stays = rounding * matched->resting;

    if (!settings->measured) {
        const sh_real friction = friction_variance(matched, rls, settings);
        R = rounding + square(gamma * settings->noise) + friction / white(settings);
        stays += friction * matched->unsure;
    }
    return R * square(1 + stays / R);
}

/* Keeps the rounding of theta out of what is said about B. There is none while theta rests. */
static void compensate(sh_matched_regression *matched, sh_least_squares *rls,
                       const sh_matched_settings *settings, sh_real variance)
{
    const sh_real deviation = square(settings->motor.gamma) * settings->motor.B * settings->count;

    if (matched->motion.waiting == 0 && sh_fabs(matched->motion.change) > 0) /* a count came */
        matched->bias.surplus += square(deviation) / 12 * matched->rounding / variance;
    sh_rounding_bias_take_back(&matched->bias, rls, matched->basis + SH_MOTOR_B,
                               square(settings->motor_prior[SH_MOTOR_B]));
}

/* Lets the torque curve drift where this sample looks at it, and nowhere else.
 *
 * As a random walk, the curve would gain drift T of its prior variance P_0 in a sample. It gains
 * it along P_0 F only, the change of the curve that matters most here, and no more than the sample
 * can tell from its noise: what is not looked at is not forgotten. After the directional
 * forgetting of Kulhavy 1987, Automatica 23:589-600, and Cao and Schwartz 2000, Automatica
 * 36:1725-1731, who take from the information; here no variance grows beyond the prior. Motor data
 * are taken to be constant.
 */
static void drift(sh_matched_regression *matched, sh_least_squares *rls,
                  const sh_matched_settings *settings, const sh_real *F, sh_real noise)
{
    sh_real *direction = matched->work.direction; /* zero beyond the basis */
    sh_real along = 0, power = 0;
    int i;

    for (i = 0; i < matched->basis; ++i)
        along += matched->eta_0[i] * F[i];
    for (i = 0; i < matched->basis; ++i) {
        direction[i] =
            square(settings->torque) * F[i] + square(settings->nominal) * matched->eta_0[i] * along;
        power += F[i] * direction[i];
    }
    if (!(power > 0))
        return;
    sh_least_squares_widen(rls, settings->drift * settings->T / (power + noise), direction);
    for (i = 0; i < matched->basis; ++i)
        sh_least_squares_bound(rls, i, prior_variance(matched, settings, i));
    for (i = 0; i < SH_MAX_MOTOR; ++i)
        sh_least_squares_bound(rls, matched->basis + i, square(settings->motor_prior[i]));
}

/* Whether phi changed by more than the rounding of q - theta, where both may have moved on by the
 * same number of counts.
 */
static int moved(const sh_matched_settings *settings, sh_real change)
{
    return sh_fabs(change) > sh_fmin(settings->count, settings->count_q) / 4;
}

/* Whether a sample contradicts the motor at rest with which the filters began: by more than five
 * standard deviations of what the filter leaves of the noise. Here this is the variance asked for,
 * not what a sample may weigh beside others.
 */
static int was_moving(const sh_matched_regression *matched, sh_least_squares *rls,
                      const sh_matched_settings *settings, const sh_real *F, sh_real y)
{
    const sh_real gamma = settings->motor.gamma;
    const sh_real inertial = square(gamma) * settings->motor.B * settings->count;
    const sh_real variance = white(settings) * square(gamma * settings->noise) +
                             square(inertial) / 12 * matched->rounding +
                             friction_variance(matched, rls, settings);
    sh_real epsilon = y;
    int i;

    for (i = 0; i < rls->size; ++i)
        epsilon -= F[i] * rls->eta[i];
    return square(epsilon) > 25 * (variance + sh_least_squares_variance(rls, F));
}

int sh_matched_step(sh_matched_regression *matched, sh_least_squares *rls,
                    const sh_matched_settings *settings, sh_real theta, sh_real torque, sh_real phi,
                    sh_real sigma, const sh_real *F, sh_real *y, sh_innovation *innovation)
{
    sh_real *column = matched->work.F;
    sh_real variance;

    innovation->a = 0;
    innovation->rho = 0;
    innovation->epsilon = 0;
    if (!matched->begun)
        begin_filters(matched, theta, torque, F);
    else
        filter(matched, settings, theta, torque, F);
    matched->resting = moved(settings, phi - matched->phi) ? 0 : matched->resting + 1;
    matched->phi = phi;
    matched->begun = 1;
    *y = regression(matched, settings, column);
    matched->settling -= settings->T;
    if (matched->settling > 0)
        return 1;
    matched->settling = 0;

    variance = noise_variance(matched, rls, settings, sigma);
    if (!settings->measured && matched->starting > 0) {
        matched->starting -= settings->T;
        if (was_moving(matched, rls, settings, column, *y)) {
            matched->settling = FORGOTTEN / settings->bandwidth;
            matched->starting = 0;
            return 1;
        }
    }
    if (!sh_least_squares_weigh(rls, 1 / variance, column, *y, &innovation->epsilon,
                                &innovation->rho))
        return 0;
    innovation->rho /= variance;
    innovation->a = 1;
    if (!settings->measured && settings->motor_prior[SH_MOTOR_B] > 0)
        compensate(matched, rls, settings, variance);
    if (settings->drift > 0)
        drift(matched, rls, settings, column, variance);
    return 1;
}

sh_real sh_matched_belief(const sh_matched_regression *matched, sh_least_squares *rls,
                          const sh_matched_settings *settings, const sh_real *dF, sh_real *eta)
{
    return sh_rounding_bias_belief(&matched->bias, rls, matched->basis + SH_MOTOR_B,
                                   square(settings->motor_prior[SH_MOTOR_B]), dF, eta);
}
