#include "stiffness_estimator.h"

#include <string.h>

#include "real_math.h"

/* Regressor and its derivative by phi at an operating point, in the units of the method. */
static void basis(const sh_parameters *p, sh_real phi, sh_real set_point, sh_real *F, sh_real *dF)
{
    if (p->method == SH_METHOD_MATCHED_FILTER)
        sh_scaled_basis(&p->range, p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi, F, dF);
    else
        sh_torque_basis(p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi, F, dF);
}

/* What P of the paper's recursion is to be multiplied by to be a covariance [(N.m)2]: the noise
 * of the torque as if it were white, times the weight that (27) gives to every sample.
 */
static sh_real noise_of_paper(const sh_parameters *p)
{
    const sh_real noise =
        p->modality == SH_MODALITY_RESIDUAL ? p->motor.gamma * p->noise.tau : p->noise.tau_e;

    return noise * noise * (p->rls.kind == SH_RLS_ENHANCED ? p->rls.c : 1);
}

/* Resolution of an encoder [rad], 0 without quantisation. */
static sh_real count_of(sh_real counts_per_turn)
{
    return counts_per_turn > 0 ? (sh_real)(2 * SH_PI) / counts_per_turn : 0;
}

static sh_matched_settings matched_settings(const sh_parameters *p)
{
    sh_matched_settings s;

    s.T = p->samplePeriod;
    s.bandwidth = p->matched.bandwidth;
    s.measured = p->modality != SH_MODALITY_RESIDUAL;
    s.noise = s.measured ? p->noise.tau_e : p->noise.tau;
    s.motor = p->motor;
    s.count = count_of(p->encoder.theta);
    s.count_q = count_of(p->encoder.q);
    s.slow = p->matched.slow;
    s.drift = p->matched.drift;
    s.torque = p->prior.tau_e;
    s.nominal = p->prior.nominal;
    s.motor_prior[SH_MOTOR_D_THETA] = p->prior.D_theta;
    s.motor_prior[SH_MOTOR_B] = p->prior.B;
    s.motor_prior[SH_MOTOR_COULOMB] = p->prior.tau_coulomb;
    return s;
}

/* Torque (21) and stiffness (23) at a regressor F and its derivative dF. */
static void evaluate_curve(const sh_real *F, const sh_real *dF, const sh_real *eta, int size,
                           sh_estimate *estimate)
{
    sh_real tau_e[2] = {0, 0}, sigma[2] = {0, 0}; /* even and odd do not wait for each other */
    int i;

    for (i = 0; i + 1 < size; i += 2) {
        tau_e[0] += F[i] * eta[i];
        tau_e[1] += F[i + 1] * eta[i + 1];
        sigma[0] += dF[i] * eta[i];
        sigma[1] += dF[i + 1] * eta[i + 1];
    }
    if (i < size) {
        tau_e[0] += F[i] * eta[i];
        sigma[0] += dF[i] * eta[i];
    }
    estimate->tau_e = tau_e[0] + tau_e[1];
    estimate->sigma = sigma[0] + sigma[1];
}

/* All that follows from parameters eta, of which dF' eta has the given variance, at the operating
 * point of the regressor F and its derivative dF.
 */
static void evaluate(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                     sh_real set_point, const sh_real *eta, sh_real variance, sh_estimate *estimate)
{
    const int matched = p->method == SH_METHOD_MATCHED_FILTER;
    const int n = p->rls.n, m = p->rls.m, size = n * m;
    int i, j;

    evaluate_curve(estimator->work.F, estimator->work.dF, eta, size, estimate);
    estimate->phi = phi;
    estimate->setPoint = set_point;
    estimate->sigma_std = sh_sqrt(variance);
    estimate->confident = estimate->sigma_std < p->confidence * sh_fabs(estimate->sigma);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            estimate->eta[i][j] = eta[j * n + i] * estimator->units[j * n + i];
    estimate->D_theta_hat = p->motor.D_theta * (matched ? 1 + eta[size + SH_MOTOR_D_THETA] : 1);
    estimate->B_hat = p->motor.B * (matched ? 1 + eta[size + SH_MOTOR_B] : 1);
    estimate->tau_coulomb_hat = matched ? eta[size + SH_MOTOR_COULOMB] : 0;
}

static void evaluate_paper(sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                           sh_real set_point, sh_estimate *estimate)
{
    const sh_real variance =
        noise_of_paper(p) * sh_least_squares_variance(&estimator->rls, estimator->work.dF);

    evaluate(estimator, p, phi, set_point, estimator->rls.eta, variance, estimate);
}

void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    const int n = p->rls.n, m = p->rls.m, size = n * m;
    const sh_real set_point = p->setPoint.offset;
    sh_real eta_0[SH_MAX_BASIS], scaled[SH_MAX_PARAMETERS] = {0};
    sh_real *const units = estimator->units, *const F = estimator->work.F;
    sh_real *const dF = estimator->work.dF;
    int i, j;

    memset(estimator, 0, sizeof *estimator);
    memset(estimate, 0, sizeof *estimate);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            eta_0[j * n + i] = p->rls.eta_0[i][j];
    estimator->modality = p->modality;
    basis(p, 0, set_point, F, dF);
    if (p->method == SH_METHOD_MATCHED_FILTER) {
        const sh_matched_settings settings = matched_settings(p);
        /* What each coefficient, and the curve, add to sigma. From P the same would follow, but its
         * rounding depends on coefficients that do not act here.
         */
        sh_real each = 0, curve = 0;

        sh_scaled_basis_units(&p->range, p->rls.symmetric, n, m, units);
        for (i = 0; i < size; ++i) {
            scaled[i] = eta_0[i] * units[i];
            units[i] = 1 / units[i];
            each += dF[i] * dF[i];
            curve += dF[i] * scaled[i];
        }
        each *= p->prior.tau_e * p->prior.tau_e;
        curve *= p->prior.nominal;
        sh_matched_start(&estimator->matched, &estimator->rls, &settings, size, scaled);
        evaluate(estimator, p, 0, set_point, scaled, each + curve * curve, estimate);
        /* The estimate is eta_0 to the last digit, whatever the units. */
        sh_torque_basis(p->rls.symmetric, n, m, set_point, 0, F, dF);
        evaluate_curve(F, dF, eta_0, size, estimate);
        for (j = 0; j < m; ++j)
            for (i = 0; i < n; ++i)
                estimate->eta[i][j] = p->rls.eta_0[i][j];
    } else {
        for (i = 0; i < size; ++i)
            units[i] = 1;
        sh_least_squares_start(&estimator->rls, size, eta_0, p->rls.P_0);
        evaluate_paper(estimator, p, 0, set_point, estimate);
    }
    estimate->valid = 1;
}

static int is_measurement(sh_real z)
{
    return sh_fabs(z) <= SH_LARGEST_MEASUREMENT; /* false for NaN */
}

/* First stage: filters and residual. Returns gamma r_e [N.m]. */
static sh_real track(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z)
{
    const sh_real T = p->samplePeriod;
    const sh_real dt = T * (1 + estimator->skipped);
    sh_kinematic_kalman *theta = &estimator->theta;
    sh_kinematic_kalman *q = &estimator->q;

    if (!estimator->started) {
        sh_kinematic_kalman_start(theta, &p->filter, z->theta);
        sh_kinematic_kalman_start(q, &p->filter, z->q);
        sh_torque_residual_start(&estimator->residual, z->tau);
    } else {
        sh_kinematic_kalman_step(theta, &p->filter, z->theta, dt, count_of(p->encoder.theta) / T);
        if (p->deformation == SH_DEFORMATION_FILTERED)
            sh_kinematic_kalman_step(q, &p->filter, z->q, dt, count_of(p->encoder.q) / T);
        /* (8) bridges a gap as if it were one long sample, while that is short beside
         * 1 / K_I. Of a longer one the torque is not known: r_e stays, is wrong, and has
         * to forget before it is learned from.
         */
        estimator->settling -= dt;
        if (dt * p->residual.K_I < 2) {
            sh_torque_residual_step(&estimator->residual, &p->motor, theta->dx, theta->dx_dot,
                                    z->tau, p->residual.K_I, dt);
        } else {
            sh_torque_residual_resume(&estimator->residual, z->tau);
            estimator->settling = 10 / p->residual.K_I;
        }
    }
    estimator->started = 1;
    estimator->skipped = 0;
    return p->motor.gamma * estimator->residual.r_e;
}

/* Nominal flexibility torque at the measured positions, (28) with (30) [N.m]. */
static sh_real nominal_torque(const sh_parameters *p, const sh_measurement *z)
{
    const sh_real r = p->model.r_0 - p->model.b * z->theta_c;

    return p->model.k_s * r * r * sh_sin(2 * (z->q - z->theta));
}

/* Torque that feeds the regression: that of a sensor, of the model, or by the motor. */
static sh_real torque_of(const sh_parameters *p, const sh_measurement *z, sh_real by_motor)
{
    return p->modality == SH_MODALITY_SENSOR  ? z->tau_e_sensor
           : p->modality == SH_MODALITY_MODEL ? nominal_torque(p, z)
                                              : by_motor;
}

static int skip(sh_estimator *estimator, sh_estimate *estimate)
{
    estimator->skipped += 1;
    estimate->valid = 0;
    return 0;
}

/* The paper's two stages. Returns 0, and leaves all as it was, if the regression refuses. */
static int tick_paper(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_real set_point, sh_estimate *estimate)
{
    sh_real *const F = estimator->work.F;
    const sh_kinematic_kalman theta = estimator->theta, q = estimator->q;
    const sh_torque_residual residual = estimator->residual;
    const sh_real skipped = estimator->skipped, settling = estimator->settling;
    const int started = estimator->started;
    const sh_real tau_e_residual = track(estimator, p, z);
    sh_real phi = z->q - z->theta;
    sh_real tau_e_hat, factor;
    int kind = p->rls.kind;
    sh_innovation innovation;

    if (p->deformation == SH_DEFORMATION_FILTERED)
        phi += estimator->q.lag - estimator->theta.lag;
    basis(p, phi, set_point, F, estimator->work.dF);
    tau_e_hat = torque_of(p, z, tau_e_residual);
    factor = kind == SH_RLS_ENHANCED ? p->rls.c : p->rls.a;
    if (p->modality == SH_MODALITY_RESIDUAL && estimator->settling > 0) {
        kind = SH_RLS_CONSTANT_FACTOR; /* a = 0 learns nothing, (25) */
        factor = 0;
    }
    if (!isfinite(tau_e_residual) ||
        !sh_least_squares_update(&estimator->rls, kind, factor, F, tau_e_hat, &innovation)) {
        estimator->theta = theta;
        estimator->q = q;
        estimator->residual = residual;
        estimator->skipped = skipped;
        estimator->settling = settling;
        estimator->started = started;
        return 0;
    }
    evaluate_paper(estimator, p, phi, set_point, estimate);
    estimate->tau_e_residual = tau_e_residual;
    estimate->theta_dot = estimator->theta.x_dot;
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    return 1;
}

/* The matched filter. Returns 0, with what was learned as it was, if the regression refuses. The
 * filters begin anew after any sample that was skipped, so they need not be restored.
 */
static int tick_matched(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                        sh_real set_point, sh_estimate *estimate)
{
    sh_real *const F = estimator->work.F, *const dF = estimator->work.dF;
    const sh_matched_settings settings = matched_settings(p);
    const sh_real phi = z->q - z->theta;
    const sh_real torque = torque_of(p, z, z->tau);
    sh_real y, variance;
    sh_innovation innovation;
    int good;

    if (estimator->started && (estimator->skipped > 0 || estimator->modality != p->modality))
        sh_matched_resume(&estimator->matched, &settings);
    basis(p, phi, set_point, F, dF);
    good = sh_matched_step(&estimator->matched, &estimator->rls, &settings, z->theta, torque, phi,
                           estimate->sigma, F, &y, &innovation);
    variance =
        sh_matched_belief(&estimator->matched, &estimator->rls, &settings, dF, estimator->work.eta);
    if (!good || !isfinite(y) || !isfinite(variance)) { /* y, variance: while nothing is learned */
        estimator->matched.begun = 0;
        return 0;
    }
    estimator->started = 1;
    estimator->skipped = 0;
    estimator->modality = p->modality;
    evaluate(estimator, p, phi, set_point, estimator->work.eta, variance, estimate);
    estimate->tau_e_residual = y;
    estimate->theta_dot =
        sh_state_variable_filter_first(&estimator->matched.theta, &estimator->matched.design);
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    return 1;
}

int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate)
{
    const sh_real set_point = p->setPoint.offset + p->setPoint.scale * z->theta_c;
    int good;

    if (!is_measurement(z->theta) || !is_measurement(z->q) || !is_measurement(z->theta_c) ||
        !is_measurement(z->tau) || !is_measurement(z->tau_e_sensor))
        return skip(estimator, estimate);
    good = p->method == SH_METHOD_MATCHED_FILTER
               ? tick_matched(estimator, p, z, set_point, estimate)
               : tick_paper(estimator, p, z, set_point, estimate);
    if (!good)
        return skip(estimator, estimate);
    estimate->valid = 1;
    return 1;
}
