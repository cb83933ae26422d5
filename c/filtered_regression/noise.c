/* The variance of a row, and the noise in the columns of a row. */
#include "real_math.h"
#include "regression.h"
#include "state_variable_filter.h"

/* Share of excess noise in the variance of a row [1]. With 0.1, intervals are too narrow under jitter; with 1, too
 * wide.
 */
#define SH_EXCESS ((sh_real)0.3)
/* Share of the rounding variance count^2/12 that fourth differences do not show [1]: mean for 1 to 100 counts. */
#define SH_ROUNDING_IS_NOT_WHITE ((sh_real)0.056)

/* Returns the sum of the squared counts of both encoders [rad2], which is 12 times the rounding variance of phi. */
static sh_real counts_squared(const sh_signals *signals)
{
    return sh_square(signals->count) + sh_square(signals->count_q);
}

/* (gamma^2 B)^2 G: noise in the y of a row by noise of theta [(N.m/rad)2] */
static sh_real inertial_noise(const sh_signals *signals, const sh_parameters *p)
{
    return sh_square(sh_square(p->motor.gamma) * p->motor.B) * signals->gain_second;
}

/* gamma^2 (tau_C^2 + P_CC) u_f^2: variance of the friction whose sign is unknown [(N.m)2] */
sh_real sh_noise_of_friction(const sh_signals *signals, const sh_columns *columns,
                             const sh_posterior *posterior, const sh_real *beta,
                             const sh_parameters *p)
{
    const sh_filters *filters = &signals->filters;
    const sh_real u_f = filters->input[SH_FILTER_UNKNOWN] - filters->behind[2][SH_FILTER_UNKNOWN];
    const int size = columns->size, C = sh_columns_place(columns, SH_COLUMN_COULOMB);
    sh_real c[SH_MAX_COLUMNS] = {0}, square; /* of the coefficient of tau_C */

    if (C < 0 || !(sh_fabs(u_f) > 0) || sh_is_measured(p)) {
        return 0;
    }
    c[C] = 1;
    square = sh_square(beta[C]) + sh_posterior_variances(posterior, p->prior.B, c, c, size).first;
    return sh_square(p->motor.gamma * p->prior.tau_coulomb * u_f) * square;
}

/* (F9), for one sample:
 *
 * R = (sigma^2 (count^2 + count_q^2)/12 + (gamma s_tau)^2) (1 + 0.3 (X - 1))
 *       + 16/(3 w T) gamma^2 (tau_C^2 + P_CC) u_f^2
 *
 * White noise counts as before the filter (section 5). Behind the filter, a wrong sign of
 * friction in one sample is the impulse response h, which changes many samples. The variance of friction is therefore
 * divided by T integral of h^2 = 3/16 w T.
 *
 * Errors that do not average out (F11): R is the variance of the independent part of the error, and c is the
 * variance of the constant part. In this case, n samples have the information 1 / (R / n + c), so the n-th sample has
 * the variance
 *
 *     R (1 + c n / R)^2 ,
 *
 * and a row of K samples a K-th of it.
 *
 * After the filter (F10): N_tau = G_0 (gamma s_tau)^2 by the torque, N_theta by theta, with the noise of rounding at least,
 * and N_C by friction of unknown sign. X is N_tau + N_theta divided by the value of this sum with rounding alone.
 * Jitter of the sample times increases X. lambda = N_tau / (N_tau + N_theta + N_C), (F14).
 */
sh_row_noise sh_noise_of_row(const sh_signals *signals, const sh_feedback *feedback,
                             sh_real friction, const sh_parameters *p)
{
    const sh_history *history = &signals->history;
    const sh_filter_design *design = &signals->design;
    const sh_real rounding = sh_square(feedback->sigma) * counts_squared(signals) / 12;
    sh_real R = rounding + sh_square(p->noise.tau_e), stays = rounding * history->resting;
    sh_row_noise noise = {0, 0, 0, 0, 0};

    if (!sh_is_measured(p)) {
        const sh_real inertial = inertial_noise(signals, p);
        const sh_real rounded = sh_square(signals->count) / 12;
        const sh_real torque = sh_square(p->motor.gamma * p->noise.tau);
        sh_real whole, X;

        noise.friction = friction;
        noise.torque = signals->gain * torque;
        whole = noise.torque + inertial * sh_fmax(history->rough, rounded);
        X = sh_fmax(1, whole / (noise.torque + inertial * rounded));
        whole += noise.friction;
        noise.share = whole > 0 ? noise.torque / whole : 0;
        R = (rounding + torque) * (1 + SH_EXCESS * (X - 1)) +
            noise.friction / ((sh_real)(3.0 / 16) * design->w * design->T);
        stays += noise.friction * history->unsure;
    }
    noise.lasting = sh_square(1 + stays / R);
    noise.R = R * noise.lasting / (sh_real)signals->decimation;
    return noise;
}

/* G_0 (count^2 + count_q^2)/12 */
sh_real sh_noise_of_deformation(const sh_signals *signals)
{
    return signals->gain * counts_squared(signals) / 12;
}

/* (F12): N R = (gamma^2 B prior.B)^2 G V. V is the mean over samples of the squared fourth difference / 70. A sample in which
 * the position changes adds 0.056 (count^2 / 12) to the mean V.
 */
sh_real sh_noise_of_inertia(const sh_signals *signals, const sh_row *row, const sh_parameters *p)
{
    const sh_real V =
        row->rough + SH_ROUNDING_IS_NOT_WHITE * row->moved * sh_square(signals->count) / 12;

    return sh_is_measured(p) ? 0 : sh_square(p->prior.B) * inertial_noise(signals, p) * V;
}
