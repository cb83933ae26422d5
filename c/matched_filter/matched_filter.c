/* Method MatchedFilter: the regression of matched_regression.h in units that suit its priors. */
#include "least_squares.h"
#include "matched_regression.h"
#include "method.h"
#include "real_math.h"
#include "scaled_basis.h"
#include "state_variable_filter.h"

/* Whether a nominal curve is given and may be wrong as a whole. */
static int has_nominal_curve(const sh_parameters *p)
{
    int i, j;

    for (i = 0; i < p->rls.n; ++i)
        for (j = 0; j < p->rls.m; ++j)
            if (sh_fabs(p->rls.eta_0[i][j]) > 0)
                return p->prior.nominal > 0;
    return 0;
}

static int check_matched_filter(const sh_parameters *p, sh_violation *violation)
{
    const sh_real wT = p->matched.bandwidth * p->samplePeriod;

    if (wT < (sh_real)1e-4 || wT >= 2)
        return sh_violates(violation, "matched.bandwidth", p->matched.bandwidth,
                           ">= 1e-4 / samplePeriod and < 2 / samplePeriod");
    if (!(p->prior.tau_e > 0) && !has_nominal_curve(p))
        return sh_violates(violation, "prior.tau_e", p->prior.tau_e,
                           "> 0, or 0 with a curve rls.eta_0 and prior.nominal > 0");
    return 0;
}

/* Motor data with the relative errors d and b of the regression, and its Coulomb friction. */
static void report_motor(const sh_parameters *p, const sh_real *motor, sh_estimate *estimate)
{
    estimate->D_theta_hat = p->motor.D_theta * (1 + motor[SH_MOTOR_D_THETA]);
    estimate->B_hat = p->motor.B * (1 + motor[SH_MOTOR_B]);
    estimate->tau_coulomb_hat = motor[SH_MOTOR_COULOMB];
}

static void start_matched_filter(sh_estimator *estimator, const sh_parameters *p,
                                 const sh_real *eta_0, sh_estimate *estimate, sh_fit *fit)
{
    static const sh_real no_error[SH_MAX_MOTOR] = {0};
    const int n = p->rls.n, m = p->rls.m, size = n * m;
    sh_real *const units = estimator->units, *const scaled = estimator->work.eta;
    sh_real each = 0, curve = 0; /* std deviations of sigma by the two priors of the torque */
    int i;

    sh_scaled_basis(&p->range, p->rls.symmetric, n, m, p->setPoint.offset, 0, estimator->work.F,
                    estimator->work.dF);
    sh_scaled_basis_units(&p->range, p->rls.symmetric, n, m, units);
    for (i = 0; i < size; ++i) {
        scaled[i] = eta_0[i] * units[i];
        units[i] = 1 / units[i];
        each += estimator->work.dF[i] * estimator->work.dF[i];
        curve += estimator->work.dF[i] * scaled[i];
    }
    sh_matched_start(&estimator->method.matched, &estimator->rls, p, scaled);
    fit->eta = scaled;
    /* The same would follow from P, but with the rounding of coefficients that do not act here. */
    each *= p->prior.tau_e * p->prior.tau_e;
    curve *= p->prior.nominal;
    fit->variance = each + curve * curve;
    report_motor(p, no_error, estimate);
}

static int tick_matched_filter(sh_estimator *estimator, const sh_parameters *p,
                               const sh_measurement *z, sh_real set_point, sh_estimate *estimate,
                               sh_fit *fit)
{
    sh_matched_regression *matched = &estimator->method.matched;
    sh_real *const F = estimator->work.F, *const dF = estimator->work.dF;
    sh_real *const eta = estimator->work.eta;
    const sh_real phi = z->q - z->theta;
    sh_real y, variance;
    sh_innovation innovation;
    int good;

    if (estimator->started && (estimator->skipped > 0 || matched->modality != p->modality))
        sh_matched_resume(matched, p);
    sh_scaled_basis(&p->range, p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi, F, dF);
    good =
        sh_matched_step(matched, &estimator->rls, p, z->theta, sh_regression_torque(p, z, z->tau),
                        phi, estimate->sigma, F, &y, &innovation);
    variance = sh_matched_estimate(matched, &estimator->rls, p, dF, eta);
    if (!good || !isfinite(y) || !isfinite(variance)) { /* the latter while nothing is learned */
        matched->begun = 0; /* the filters start again, so their old state does not matter */
        return 0;
    }
    matched->modality = p->modality;
    estimate->phi = phi;
    estimate->tau_e_residual = y;
    estimate->theta_dot = sh_state_variable_filter_first(&matched->theta, &matched->design);
    estimate->a = innovation.a;
    estimate->rho = innovation.rho;
    estimate->epsilon = innovation.epsilon;
    fit->eta = eta;
    fit->variance = variance;
    report_motor(p, eta + matched->basis, estimate);
    return 1;
}

const sh_method sh_matched_filter = {
    /* With the usual rls.n = 3, the highest power is there 32 times as large as at range.phi. */
    .largest_deformation = 2,
    .check = check_matched_filter,
    .start = start_matched_filter,
    .tick = tick_matched_filter,
};
