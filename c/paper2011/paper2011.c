/* Method Paper2011: filters and residual, then least squares of the torque; the paper's Fig. 1. */
#include "kinematic_kalman.h"
#include "least_squares.h"
#include "method.h"
#include "pair.h"
#include "real_math.h"
#include "torque_basis.h"
#include "torque_residual.h"

static int check_paper2011(const sh_parameters *p, sh_violation *violation)
{
    if (p->residual.K_I * p->samplePeriod >= 2) {
        return sh_violates(violation, "residual.K_I", p->residual.K_I,
                           ">= 1e-15 and < 2 / samplePeriod");
    }
    return 0;
}

/* Returns the unit of P: the matrix P of the recursion times this unit is a covariance [(N.m)2]. The unit is the
 * variance of the torque noise, as if the noise were white, times the weight that (27) gives to every sample.
 */
static sh_real unit_of_covariance(const sh_parameters *p)
{
    const sh_real noise =
        p->modality == SH_MODALITY_RESIDUAL ? p->motor.gamma * p->noise.tau : p->noise.tau_e;

    return noise * noise * (p->rls.kind == SH_RLS_ENHANCED ? p->rls.c : 1);
}

/* Torque and stiffness F' eta and dF' eta, (21) and (23). The variances contain only the white noise of the torque, but
 * not the errors of the motor data and the lag of the residual. The method Paper2011 is therefore never confident.
 *
 * variance  F' P F
 */
static void evaluate_regressors(const sh_paper2011_state *state, const sh_parameters *p,
                                const sh_real *F, const sh_real *dF, sh_real variance,
                                sh_point *point)
{
    const sh_real unit = unit_of_covariance(p);

    sh_scalar_products(state->rls.eta, F, dF, p->rls.n * p->rls.m, &point->tau_e, &point->sigma);
    point->tau_e_std = sh_std_deviation(unit * variance);
    point->sigma_std = sh_std_deviation(unit * sh_least_squares_variance(&state->rls, dF));
    point->sigma_per_gain = 1;
}

static void evaluate_paper2011(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                               sh_real set_point, sh_point *point)
{
    const sh_paper2011_state *state = &estimator->method.paper2011;
    sh_real F[SH_MAX_PARAMETERS] = {0}, dF[SH_MAX_PARAMETERS] = {0};

    sh_torque_basis(p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi, F, dF);
    evaluate_regressors(state, p, F, dF, sh_least_squares_variance(&state->rls, F), point);
}

/* Sets the outputs that are computed from the recursion, except torque and stiffness. */
static void report_paper2011(const sh_paper2011_state *state, const sh_parameters *p,
                             const sh_point *point, sh_estimate *estimate)
{
    const int n = p->rls.n, m = p->rls.m;
    int i, j;

    for (j = 0; j < m; ++j) {
        for (i = 0; i < n; ++i) {
            estimate->eta[i][j] = state->rls.eta[j * n + i];
        }
    }
    estimate->sigma_std = point->sigma_std;
    estimate->tau_e_std = point->tau_e_std;
    estimate->D_theta_hat = p->motor.D_theta;
    estimate->B_hat = p->motor.B;
    estimate->misfit = 1;
    estimate->sigma_per_gain = point->sigma_per_gain;
    estimate->doubt = SH_DOUBT_NO_CLAIM;
}

static void start_paper2011(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    sh_paper2011_state *const state = &estimator->method.paper2011;
    const int n = p->rls.n, m = p->rls.m;
    sh_real eta_0[SH_MAX_BASIS] = {0};
    sh_point point;
    int i, j;

    for (j = 0; j < m; ++j) {
        for (i = 0; i < n; ++i) {
            eta_0[j * n + i] = p->rls.eta_0[i][j];
        }
    }
    state->filters.theta_w_s = sh_encoder_count(p->encoder.theta) / p->samplePeriod;
    state->filters.q_w_s = sh_encoder_count(p->encoder.q) / p->samplePeriod;
    sh_least_squares_start(&state->rls, n * m, eta_0, p->rls.P_0);
    evaluate_paper2011(estimator, p, 0, p->setPoint.offset, &point);
    report_paper2011(state, p, &point, estimate);
}

/* First stage: filters and residual. Returns gamma r_e [N.m].
 *
 * dt  time since the last good sample [s], 0 for the first one
 */
static sh_real track(sh_paper2011_filters *state, const sh_parameters *p, const sh_measurement *z,
                     sh_real dt)
{
    sh_kinematic_kalman *theta = &state->theta, *q = &state->q;

    if (!(dt > 0)) {
        sh_kinematic_kalman_start(theta, &p->filter, z->theta);
        sh_kinematic_kalman_start(q, &p->filter, z->q);
        sh_torque_residual_start(&state->residual, z->tau);
        return p->motor.gamma * state->residual.r_e;
    }
    sh_kinematic_kalman_step(theta, &p->filter, z->theta, dt, state->theta_w_s);
    if (p->deformation == SH_DEFORMATION_FILTERED) {
        sh_kinematic_kalman_step(q, &p->filter, z->q, dt, state->q_w_s);
    }
    /* If a gap is short compared with 1 / K_I, (8) integrates over the gap as over one long sample. After a longer gap,
     * the torque within the gap is unknown. In this case, r_e starts from the last value, which is wrong, and the
     * regression waits until the effect of this value has decayed.
     */
    state->settling -= dt;
    if (dt * p->residual.K_I < 2) {
        return sh_torque_residual_step(&state->residual, &p->motor, theta->dx, theta->dx_dot,
                                       z->tau, p->residual.K_I, dt);
    }
    state->residual.tau = z->tau;
    state->settling = 10 / p->residual.K_I;
    return p->motor.gamma * state->residual.r_e;
}

static int tick_paper2011(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                          sh_real set_point, sh_estimate *estimate)
{
    const sh_real dt = estimator->started ? p->samplePeriod * (sh_real)(1 + estimator->skipped) : 0;
    sh_paper2011_state *const state = &estimator->method.paper2011;
    const sh_paper2011_filters before = state->filters;
    const sh_real tau_e_residual = track(&state->filters, p, z, dt);
    sh_real F[SH_MAX_PARAMETERS] = {0}, dF[SH_MAX_PARAMETERS] = {0}, factor;
    sh_real phi = z->q - z->theta;
    int kind = p->rls.kind;
    sh_innovation innovation = {0, 0, 0, 0};
    sh_point point;

    if (p->deformation == SH_DEFORMATION_FILTERED) {
        phi += state->filters.q.lag - state->filters.theta.lag;
    }
    sh_torque_basis(p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi, F, dF);
    factor = kind == SH_RLS_ENHANCED ? p->rls.c : p->rls.a;
    if (p->modality == SH_MODALITY_RESIDUAL && state->filters.settling > 0) {
        kind = SH_RLS_CONSTANT_FACTOR; /* with a = 0 nothing changes, (25) */
        factor = 0;
    }
    if (!isfinite(tau_e_residual) || !isfinite(state->filters.theta.x_dot) ||
        !sh_least_squares_update(&state->rls, kind, factor, F,
                                 sh_regression_torque(p, z, tau_e_residual), &innovation)) {
        state->filters = before;
        return 0;
    }
    evaluate_regressors(state, p, F, dF, innovation.variance, &point);
    if (!isfinite(point.tau_e) || !isfinite(point.sigma)) {
        state->filters = before;
        return 0;
    }
    estimate->tau_e = point.tau_e;
    estimate->sigma = point.sigma;
    estimate->phi = phi;
    estimate->tau_e_residual = tau_e_residual;
    estimate->theta_dot = state->filters.theta.x_dot;
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    report_paper2011(state, p, &point, estimate);
    return 1;
}

static sh_real largest_deformation_paper2011(const sh_parameters *p)
{
    (void)p;
    return INFINITY;
}

const sh_method sh_paper2011 = {
    .largest_deformation = largest_deformation_paper2011,
    .check = check_paper2011,
    .start = start_paper2011,
    .tick = tick_paper2011,
    .evaluate = evaluate_paper2011,
};
