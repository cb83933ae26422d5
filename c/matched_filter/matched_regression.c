#include "matched_regression.h"

#include <string.h>

#include "method.h"
#include "motion_sign.h"
#include "real_math.h"
#include "rounding_bias.h"
#include "state_variable_filter.h"
#include "ud_factor.h"

/* Time constants 1/w after which a filter has forgotten its start. */
static const sh_real FORGOTTEN = 12;

static sh_real square(sh_real x)
{
    return x * x;
}

/* Whether the flexibility torque is measured or modelled, and not computed from the motor's. */
static int is_measured(const sh_parameters *p)
{
    return p->modality != SH_MODALITY_RESIDUAL;
}

/* Prior variance of coefficient i of the torque [(N.m)2]. */
static sh_real torque_prior(const sh_matched_regression *matched, const sh_parameters *p, int i)
{
    return square(p->prior.tau_e) + square(p->prior.nominal * matched->eta_0[i]);
}

/* Prior variance of coefficient i of the motor data, SH_MOTOR_*, in the square of its unit. */
static sh_real motor_prior(const sh_parameters *p, int i)
{
    const sh_real std_deviation[SH_MAX_MOTOR] = {[SH_MOTOR_D_THETA] = p->prior.D_theta,
                                                 [SH_MOTOR_B] = p->prior.B,
                                                 [SH_MOTOR_COULOMB] = p->prior.tau_coulomb};

    return square(std_deviation[i]);
}

void sh_matched_start(sh_matched_regression *matched, sh_least_squares *rls, const sh_parameters *p,
                      const sh_real *eta_0)
{
    const int basis = p->rls.n * p->rls.m;
    sh_real prior_mean[SH_MAX_PARAMETERS] = {0};
    int i;

    memset(matched, 0, sizeof *matched);
    matched->basis = basis;
    matched->modality = p->modality;
    matched->count = sh_encoder_count(p->encoder.theta);
    matched->count_q = sh_encoder_count(p->encoder.q);
    matched->design = sh_state_variable_filter_design(p->matched.bandwidth, p->samplePeriod);
    matched->rounding = sh_state_variable_filter_noise(&matched->design);
    matched->starting = FORGOTTEN / p->matched.bandwidth;
    for (i = 0; i < basis; ++i)
        matched->eta_0[i] = prior_mean[i] = eta_0[i];
    sh_least_squares_start(rls, basis + SH_MAX_MOTOR, prior_mean, square(p->prior.tau_e));
    for (i = 0; i < SH_MAX_MOTOR; ++i)
        sh_ud_factor_set_variance(&rls->P, basis + i, motor_prior(p, i));
    sh_ud_factor_widen(&rls->P, square(p->prior.nominal), prior_mean);
}

void sh_matched_resume(sh_matched_regression *matched, const sh_parameters *p)
{
    matched->begun = 0;
    matched->starting = 0;
    matched->settling = FORGOTTEN / p->matched.bandwidth;
}

/* The first sample of the filters. They assume a motor at rest, at any torque. So theta starts at
 * its value, and the signals of the equation start from zero: the equation holds from now on.
 */
static void start_filters(sh_matched_regression *matched, sh_real theta, sh_real torque,
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

static void filter(sh_matched_regression *matched, const sh_parameters *p, sh_real theta,
                   sh_real torque, const sh_real *F)
{
    const sh_filter_design *design = &matched->design;
    int i;

    sh_state_variable_filter_step(&matched->theta, design, theta);
    sh_state_variable_filter_step(&matched->torque, design, torque);
    for (i = 0; i < matched->basis; ++i)
        sh_state_variable_filter_step(&matched->column[i], design, F[i]);
    sh_motion_sign_step(&matched->motion, theta, matched->count, p->matched.slow * p->samplePeriod);
    matched->unsure = matched->motion.unknown > 0 ? matched->unsure + 1 : 0;
    sh_state_variable_filter_step_mean(&matched->friction, design, matched->motion.sign);
    sh_state_variable_filter_step_mean(&matched->unknown, design, matched->motion.unknown);
}

/* Output of the filter of the torque or of the sign of friction. The filter treats theta and the
 * columns of the torque as linear between samples although they are smooth, which reduces them by
 * the share (Omega T)^2 / 12 at the frequency Omega. The torque and the sign are treated exactly.
 * T^2 / 12 s^2 reduces them by the same share, so that the equation between all signals holds.
 */
static sh_real as_if_smooth(const sh_state_variable_filter *filter, const sh_filter_design *design)
{
    return sh_state_variable_filter_output(filter) +
           square(design->T) / 12 * sh_state_variable_filter_second(filter, design);
}

/* Sets the columns F [size: basis + SH_MAX_MOTOR] of the regression, and returns y. */
static sh_real regression(const sh_matched_regression *matched, const sh_parameters *p, sh_real *F)
{
    const sh_motor_parameters *motor = &p->motor;
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
    if (is_measured(p))
        return sh_state_variable_filter_output(&matched->torque);
    error[SH_MOTOR_D_THETA] = -viscous;
    error[SH_MOTOR_B] = -inertial;
    error[SH_MOTOR_COULOMB] = -sh_fabs(motor->gamma) * as_if_smooth(&matched->friction, design);
    return inertial + viscous - motor->gamma * as_if_smooth(&matched->torque, design);
}

/* Share of the variance of white noise that the filter leaves: T times the integral of h^2, for the
 * impulse response h of the filter, whose integral is 1.
 */
static sh_real white(const sh_parameters *p)
{
    return (sh_real)(3.0 / 16) * p->matched.bandwidth * p->samplePeriod;
}

/* Variance of the friction whose sign is unknown [(N.m)2]. */
static sh_real friction_variance(const sh_matched_regression *matched, const sh_least_squares *rls,
                                 const sh_parameters *p)
{
    const int at = matched->basis + SH_MOTOR_COULOMB;
    const sh_real tau_C = square(rls->eta[at]) + sh_ud_factor_entry(&rls->P, at, at);

    return square(p->motor.gamma) * tau_C *
           square(sh_state_variable_filter_output(&matched->unknown));
}

/* Variance of a sample [(N.m)2], as the weight of a sample needs it: of the torque's noise, of the
 * rounding of phi, and of friction.
 *
 * White noise enters as it is before the filter. A wrong sign of friction in one sample leaves the
 * filter as its impulse response h, in many samples. The mean of these samples is wrong by
 * (sum of h)^2 / (sum of h^2) = 1 / white() times as much as if they were independent, so their
 * variance is multiplied by that.
 *
 * Two errors stay the same from sample to sample: rounding, while the joint is at rest, and the
 * wrong sign of friction, while the motor creeps. If R is the variance of one sample and c the
 * variance of its part that stays, the information of n samples is 1 / (R / n + c). The n-th sample
 * adds as much to it as one of variance R (1 + c n / R)^2, and all samples together add no more
 * than 1 / c.
 */
static sh_real noise_variance(const sh_matched_regression *matched, const sh_least_squares *rls,
                              const sh_parameters *p, sh_real sigma)
{
    const sh_real rounding =
        square(sigma) * (square(matched->count) + square(matched->count_q)) / 12;
    const sh_real noise = is_measured(p) ? p->noise.tau_e : p->noise.tau;
    sh_real R = rounding + square(noise), stays = rounding * matched->resting;

    if (!is_measured(p)) {
        const sh_real friction = friction_variance(matched, rls, p);
        R = rounding + square(p->motor.gamma * noise) + friction / white(p);
        stays += friction * matched->unsure;
    }
    return R * square(1 + stays / R);
}

/* Removes the effect of the rounding of theta on b. There is none while theta does not change. */
static void compensate(sh_matched_regression *matched, sh_least_squares *rls,
                       const sh_parameters *p, sh_real variance)
{
    const sh_real deviation = square(p->motor.gamma) * p->motor.B * matched->count;
    const int changed = matched->motion.waiting == 0 && sh_fabs(matched->motion.change) > 0;

    if (changed)
        matched->bias.surplus += square(deviation) / 12 * matched->rounding / variance;
    sh_rounding_bias_remove(&matched->bias, rls, matched->basis + SH_MOTOR_B,
                            motor_prior(p, SH_MOTOR_B));
}

/* Lets the torque curve drift in the direction that this sample measures, and in no other.
 *
 * As a random walk, the curve would gain the share drift T of its prior variance P_0 in each
 * sample. Here it gains it along P_0 F only, the change of the curve that has the largest effect on
 * this sample, and no more than the sample can measure with its noise. So what is not measured is
 * not forgotten. This follows the directional forgetting of Kulhavy 1987, Automatica 23:589-600,
 * and Cao and Schwartz 2000, Automatica 36:1725-1731, who reduce the information; here no variance
 * grows beyond its prior. The motor data are constant.
 */
static void drift(sh_matched_regression *matched, sh_least_squares *rls, const sh_parameters *p,
                  const sh_real *F, sh_real noise)
{
    sh_real *direction = matched->work.direction; /* zero beyond the basis */
    sh_real along = 0, power = 0;
    int i;

    for (i = 0; i < matched->basis; ++i)
        along += matched->eta_0[i] * F[i];
    for (i = 0; i < matched->basis; ++i) {
        direction[i] =
            square(p->prior.tau_e) * F[i] + square(p->prior.nominal) * matched->eta_0[i] * along;
        power += F[i] * direction[i];
    }
    if (!(power > 0))
        return;
    sh_ud_factor_widen(&rls->P, p->matched.drift * p->samplePeriod / (power + noise), direction);
    for (i = 0; i < matched->basis; ++i)
        sh_ud_factor_bound(&rls->P, i, torque_prior(matched, p, i));
    for (i = 0; i < SH_MAX_MOTOR; ++i)
        sh_ud_factor_bound(&rls->P, matched->basis + i, motor_prior(p, i));
}

/* Whether phi changed by more than the rounding of q - theta if both moved by the same number of
 * counts.
 */
static int moved(const sh_matched_regression *matched, sh_real change)
{
    return sh_fabs(change) > sh_fmin(matched->count, matched->count_q) / 4;
}

/* Whether a sample contradicts that the motor was at rest when the filters started: its prediction
 * error is above five standard deviations. Unlike in noise_variance, this is the variance of one
 * filtered sample by itself.
 */
static int was_moving(const sh_matched_regression *matched, sh_least_squares *rls,
                      const sh_parameters *p, const sh_real *F, sh_real y)
{
    const sh_real gamma = p->motor.gamma;
    const sh_real inertial = square(gamma) * p->motor.B * matched->count;
    const sh_real variance = white(p) * square(gamma * p->noise.tau) +
                             square(inertial) / 12 * matched->rounding +
                             friction_variance(matched, rls, p);
    sh_real epsilon = y;
    int i;

    for (i = 0; i < rls->P.size; ++i)
        epsilon -= F[i] * rls->eta[i];
    return square(epsilon) > 25 * (variance + sh_ud_factor_variance(&rls->P, F));
}

int sh_matched_step(sh_matched_regression *matched, sh_least_squares *rls, const sh_parameters *p,
                    sh_real theta, sh_real torque, sh_real phi, sh_real sigma, const sh_real *F,
                    sh_real *y, sh_innovation *innovation)
{
    sh_real *column = matched->work.F;
    sh_real variance;

    innovation->a = 0;
    innovation->rho = 0;
    innovation->epsilon = 0;
    if (!matched->begun)
        start_filters(matched, theta, torque, F);
    else
        filter(matched, p, theta, torque, F);
    matched->resting = moved(matched, phi - matched->phi) ? 0 : matched->resting + 1;
    matched->phi = phi;
    matched->begun = 1;
    *y = regression(matched, p, column);
    matched->settling -= p->samplePeriod;
    if (matched->settling > 0)
        return 1;
    matched->settling = 0;

    variance = noise_variance(matched, rls, p, sigma);
    if (!is_measured(p) && matched->starting > 0) {
        matched->starting -= p->samplePeriod;
        if (was_moving(matched, rls, p, column, *y)) {
            matched->settling = FORGOTTEN / p->matched.bandwidth;
            matched->starting = 0;
            return 1;
        }
    }
    if (!sh_least_squares_weigh(rls, 1 / variance, column, *y, innovation))
        return 0;
    innovation->rho /= variance;
    if (!is_measured(p) && p->prior.B > 0)
        compensate(matched, rls, p, variance);
    if (p->matched.drift > 0)
        drift(matched, rls, p, column, variance);
    return 1;
}

sh_real sh_matched_estimate(const sh_matched_regression *matched, sh_least_squares *rls,
                            const sh_parameters *p, const sh_real *dF, sh_real *eta)
{
    return sh_rounding_bias_estimate(&matched->bias, rls, matched->basis + SH_MOTOR_B,
                                     motor_prior(p, SH_MOTOR_B), dF, eta);
}
