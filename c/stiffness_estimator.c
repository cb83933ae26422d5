/* One tick: from measurements to the stiffness by the method that the parameters choose. */
#include <string.h>

#include "method.h"
#include "real_math.h"
#include "scalar_product.h"
#include "torque_basis.h"

/* Torque (21) and stiffness (23) of coefficients eta for the regressor and its derivative at work.
 */
static void evaluate_curve(const sh_estimator *estimator, const sh_real *eta, int size,
                           sh_estimate *estimate)
{
    sh_scalar_products(eta, estimator->work.F, estimator->work.dF, size, &estimate->tau_e,
                       &estimate->sigma);
}

/* Sets all that follows from a fit. */
static void evaluate(const sh_estimator *estimator, const sh_parameters *p, sh_real set_point,
                     const sh_fit *fit, sh_estimate *estimate)
{
    const int n = p->rls.n, m = p->rls.m;
    int i, j;

    evaluate_curve(estimator, fit->eta, n * m, estimate);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            estimate->eta[i][j] = fit->eta[j * n + i] * estimator->units[j * n + i];
    estimate->setPoint = set_point;
    estimate->sigma_std = sh_sqrt(fit->variance);
    estimate->confident = estimate->sigma_std < p->confidence * sh_fabs(estimate->sigma);
    estimate->valid = 1;
}

void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    const int n = p->rls.n, m = p->rls.m;
    const sh_real set_point = p->setPoint.offset;
    sh_real eta_0[SH_MAX_BASIS];
    sh_fit fit;
    int i, j;

    memset(estimator, 0, sizeof *estimator);
    memset(estimate, 0, sizeof *estimate);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            eta_0[j * n + i] = p->rls.eta_0[i][j];
    sh_method_of(p)->start(estimator, p, eta_0, estimate, &fit);
    evaluate(estimator, p, set_point, &fit, estimate);
    /* The estimate is eta_0 to the last digit, whatever the units of the method. */
    sh_torque_basis(p->rls.symmetric, n, m, set_point, 0, estimator->work.F, estimator->work.dF);
    evaluate_curve(estimator, eta_0, n * m, estimate);
    for (j = 0; j < m; ++j)
        for (i = 0; i < n; ++i)
            estimate->eta[i][j] = p->rls.eta_0[i][j];
}

static int is_measurement(sh_real z)
{
    return sh_fabs(z) <= SH_LARGEST_MEASUREMENT; /* false if z is not a number */
}

int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate)
{
    const sh_real set_point = p->setPoint.offset + p->setPoint.scale * z->theta_c;
    sh_fit fit;

    if (!is_measurement(z->theta) || !is_measurement(z->q) || !is_measurement(z->theta_c) ||
        !is_measurement(z->tau) || !is_measurement(z->tau_e_sensor) ||
        !sh_method_of(p)->tick(estimator, p, z, set_point, estimate, &fit)) {
        estimator->skipped += 1;
        estimate->valid = 0;
        return 0;
    }
    estimator->started = 1;
    estimator->skipped = 0;
    evaluate(estimator, p, set_point, &fit, estimate);
    return 1;
}
