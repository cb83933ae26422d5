#include "stiffness_estimator.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* Torque (21) and stiffness (23) of the present eta. */
static void evaluate(const sh_least_squares *rls, const double *F, const double *dF,
                     sh_estimate *estimate)
{
    int i;

    estimate->tau_e = 0.0;
    estimate->sigma = 0.0;
    for (i = 0; i < rls->size; ++i) {
        estimate->tau_e += F[i] * rls->eta[i];
        estimate->sigma += dF[i] * rls->eta[i];
    }
}

void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    static const sh_kinematic_kalman at_rest = {0};
    double eta_0[SH_MAX_PARAMETERS], F[SH_MAX_PARAMETERS], dF[SH_MAX_PARAMETERS];
    int i, j;

    for (i = 0; i < SH_MAX_N; ++i) {
        for (j = 0; j < SH_MAX_M; ++j) {
            estimate->eta[i][j] = 0.0;
            if (i < p->rls.n && j < p->rls.m) {
                eta_0[j * p->rls.n + i] = p->rls.eta_0[i][j];
                estimate->eta[i][j] = p->rls.eta_0[i][j];
            }
        }
    }
    estimator->theta = at_rest;
    estimator->q = at_rest;
    sh_torque_residual_start(&estimator->residual, 0.0);
    sh_least_squares_start(&estimator->rls, p->rls.n * p->rls.m, eta_0, p->rls.P_0);
    estimator->started = 0;
    estimator->skipped = 0.0;
    estimator->settling = 0.0;

    estimate->phi = 0.0;
    estimate->setPoint = p->setPoint.offset;
    estimate->tau_e_residual = 0.0;
    estimate->theta_dot = 0.0;
    estimate->a = 0.0;
    estimate->rho = 0.0;
    estimate->epsilon = 0.0;
    estimate->valid = 1;
    sh_torque_basis(p->rls.symmetric, p->rls.n, p->rls.m, estimate->setPoint, estimate->phi, F,
                    dF);
    evaluate(&estimator->rls, F, dF, estimate);
}

static int is_measurement(double z)
{
    return fabs(z) <= SH_LARGEST_MEASUREMENT; /* false for NaN */
}

/* Velocity of one count per sample, w_s of (11) [rad/s]. */
static double count_per_sample(double counts_per_turn, double T)
{
    return counts_per_turn > 0.0 ? 2.0 * PI / counts_per_turn / T : 0.0;
}

/* First stage: filters and residual. Returns gamma r_e [N.m]. */
static double track(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z)
{
    const double T = p->samplePeriod;
    const double dt = T * (1.0 + estimator->skipped);
    sh_kinematic_kalman *theta = &estimator->theta;
    sh_kinematic_kalman *q = &estimator->q;

    if (!estimator->started) {
        sh_kinematic_kalman_start(theta, &p->filter, z->theta);
        sh_kinematic_kalman_start(q, &p->filter, z->q);
        sh_torque_residual_start(&estimator->residual, z->tau);
    } else {
        sh_kinematic_kalman_step(theta, &p->filter, z->theta, dt,
                                 count_per_sample(p->encoder.theta, T));
        if (p->deformation == SH_DEFORMATION_FILTERED)
            sh_kinematic_kalman_step(q, &p->filter, z->q, dt,
                                     count_per_sample(p->encoder.q, T));
        /* (8) bridges a gap as if it were one long sample, while that is short beside
         * 1 / K_I. Of a longer one the torque is not known: r_e stays, is wrong, and has
         * to forget before it is learned from.
         */
        estimator->settling -= dt;
        if (dt * p->residual.K_I < 2.0) {
            sh_torque_residual_step(&estimator->residual, &p->motor, theta->dx, theta->dx_dot,
                                    z->tau, p->residual.K_I, dt);
        } else {
            sh_torque_residual_resume(&estimator->residual, z->tau);
            estimator->settling = 10.0 / p->residual.K_I;
        }
    }
    estimator->started = 1;
    estimator->skipped = 0.0;
    return p->motor.gamma * estimator->residual.r_e;
}

/* Nominal flexibility torque at the measured positions, (28) with (30) [N.m]. */
static double nominal_torque(const sh_parameters *p, const sh_measurement *z)
{
    const double r = p->model.r_0 - p->model.b * z->theta_c;

    return p->model.k_s * r * r * sin(2.0 * (z->q - z->theta));
}

static int skip(sh_estimator *estimator, sh_estimate *estimate)
{
    estimator->skipped += 1.0;
    estimate->valid = 0;
    return 0;
}

int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate)
{
    double F[SH_MAX_PARAMETERS], dF[SH_MAX_PARAMETERS];
    const sh_kinematic_kalman theta = estimator->theta;
    const sh_kinematic_kalman q = estimator->q;
    const sh_torque_residual residual = estimator->residual;
    const int started = estimator->started;
    const double skipped = estimator->skipped;
    const double settling = estimator->settling;
    const int n = p->rls.n, m = p->rls.m;
    sh_innovation innovation;
    double tau_e_residual, tau_e_hat, factor, phi, set_point;
    int i, j, kind;

    if (!is_measurement(z->theta) || !is_measurement(z->q) || !is_measurement(z->theta_c) ||
        !is_measurement(z->tau) || !is_measurement(z->tau_e_sensor))
        return skip(estimator, estimate);

    tau_e_residual = track(estimator, p, z);
    phi = p->deformation == SH_DEFORMATION_FILTERED ? estimator->q.lag - estimator->theta.lag
                                                    : 0.0;
    phi += z->q - z->theta;
    set_point = p->setPoint.offset + p->setPoint.scale * z->theta_c;
    sh_torque_basis(p->rls.symmetric, n, m, set_point, phi, F, dF);

    tau_e_hat = p->modality == SH_MODALITY_SENSOR  ? z->tau_e_sensor
                : p->modality == SH_MODALITY_MODEL ? nominal_torque(p, z)
                                                   : tau_e_residual;
    kind = p->rls.kind;
    factor = kind == SH_RLS_ENHANCED ? p->rls.c : p->rls.a;
    if (p->modality == SH_MODALITY_RESIDUAL && estimator->settling > 0.0) {
        kind = SH_RLS_CONSTANT_FACTOR; /* a = 0 learns nothing, (25) */
        factor = 0.0;
    }
    if (!isfinite(tau_e_residual) ||
        !sh_least_squares_update(&estimator->rls, kind, factor, F, tau_e_hat,
                                 &innovation)) {
        estimator->theta = theta;
        estimator->q = q;
        estimator->residual = residual;
        estimator->started = started;
        estimator->skipped = skipped;
        estimator->settling = settling;
        return skip(estimator, estimate);
    }

    evaluate(&estimator->rls, F, dF, estimate);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            estimate->eta[i][j] = estimator->rls.eta[j * n + i];
    estimate->tau_e_residual = tau_e_residual;
    estimate->theta_dot = estimator->theta.x_dot;
    estimate->phi = phi;
    estimate->setPoint = set_point;
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    estimate->valid = 1;
    return 1;
}
