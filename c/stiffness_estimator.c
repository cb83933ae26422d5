/* One tick: computes the stiffness from the measurements by the method that the parameters choose. */
#include <string.h>

#include "method.h"
#include "real_math.h"
#include "torque_basis.h"

static void judge(sh_real set_point, sh_estimate *estimate)
{
    estimate->setPoint = set_point;
    estimate->confident = estimate->doubt == SH_DOUBT_NONE;
    estimate->valid = 1;
}

/* Sum over j of coefficients eta_0[i][j] of set_point^j. */
static sh_real polynomial(const sh_parameters *p, int i, sh_real set_point)
{
    sh_real sum = 0;
    int j;

    for (j = p->rls.m - 1; j >= 0; --j) {
        sum = sum * set_point + p->rls.eta_0[i][j];
    }
    return sum;
}

/* Sets the start estimate: the curve rls.eta_0, and torque and stiffness of this curve at phi = 0. */
static void start_curve(const sh_parameters *p, sh_real set_point, sh_estimate *estimate)
{
    const int linear = sh_torque_basis_linear(p->rls.symmetric);
    int i, j;

    for (i = 0; i < p->rls.n; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            estimate->eta[i][j] = p->rls.eta_0[i][j];
        }
    }
    if (!p->rls.symmetric) {
        estimate->tau_e = sh_limited(polynomial(p, 0, set_point), SH_LARGEST_OUTPUT);
    }
    if (linear < p->rls.n) {
        estimate->sigma = sh_limited(polynomial(p, linear, set_point), SH_LARGEST_OUTPUT);
    }
}

void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    (void)memset(estimator, 0, sizeof *estimator);
    (void)memset(estimate, 0, sizeof *estimate);
    start_curve(p, p->setPoint.offset, estimate);
    estimate->change_age = -1;
    sh_method_of(p)->start(estimator, p, estimate);
    judge(p->setPoint.offset, estimate);
}

static int is_measurement(sh_real z)
{
    return sh_fabs(z) <= SH_LARGEST_MEASUREMENT; /* false if z is not a number */
}

int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate)
{
    const sh_real set_point = p->setPoint.offset + p->setPoint.scale * z->theta_c;

    if (!is_measurement(z->theta) || !is_measurement(z->q) || !is_measurement(z->theta_c) ||
        !is_measurement(z->tau) || !is_measurement(z->tau_e_sensor) || !isfinite(set_point) ||
        !sh_method_of(p)->tick(estimator, p, z, set_point, estimate)) {
        if (estimator->skipped < SH_MOST_TICKS) {
            estimator->skipped += 1;
        }
        estimate->valid = 0;
        return 1;
    }
    estimator->started = 1;
    estimator->skipped = 0;
    judge(set_point, estimate);
    return 0;
}

int sh_estimator_evaluate(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                          sh_real setPoint, sh_point *point)
{
    if (isfinite(phi) && isfinite(setPoint)) {
        sh_method_of(p)->evaluate(estimator, p, phi, setPoint, point);
        if (isfinite(point->tau_e) && isfinite(point->sigma)) {
            return 0;
        }
    }
    point->tau_e = point->tau_e_std = INFINITY;
    point->sigma = point->sigma_std = point->sigma_per_gain = INFINITY;
    return 1;
}
