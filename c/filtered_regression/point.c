/* Torque and stiffness at a point, with their uncertainty, from the coefficients. */
#include "method.h"
#include "pair.h"
#include "real_math.h"
#include "regression.h"

/* Error of phi from encoder harmonics and gear, divided by the once-per-turn error of the link encoder [1]. With 0.025,
 * the estimate of a stiff joint with a free inertia is confident and wrong.
 */
#define SH_HARMONICS ((sh_real)0.035)
/* Largest change of the stiffness by these position errors, in std deviations of the stiffness [1]. */
#define SH_LARGEST_PULL ((sh_real)2)
/* Limit of x^e for x = |phi| / range.phi and the highest exponent e [1]. Beyond this limit and SH_LEAST_LIMIT, the
 * estimate is not confident.
 */
#define SH_LARGEST_POWER ((sh_real)32)

/* The highest power is 32 times its value at range.phi, but |phi| is at least twice range.phi. */
sh_real sh_largest_deformation(const sh_parameters *p)
{
    const int e = sh_power_of_phi(p->rls.symmetric, p->rls.n - 1);

    return p->range.phi * sh_fmax(SH_LEAST_LIMIT, sh_exp(sh_log(SH_LARGEST_POWER) / (sh_real)e));
}

/* Returns the variance of torque or stiffness by errors of phi, which make the value too small by the share v sum
 * V_phi/R (F25). Errors that repeat with the position change the value by at most two std deviations. A larger
 * change would also move coefficients of the motor far from their priors.
 *
 * value     times v sum 1/R
 * rounding  V_phi by rounding [rad2]
 * variance  of the value
 */
static sh_real of_errors(const sh_parameters *p, sh_real value, sh_real rounding, sh_real variance)
{
    const sh_real harmonics = sh_square(SH_HARMONICS * p->prior.eccentric);

    return sh_square(rounding * value) +
           sh_fmin(sh_square(harmonics * value), sh_square(SH_LARGEST_PULL) * variance);
}

/* tau_e = F' beta, (21), and sigma = dF' beta, (23), with the curve rls.eta_0. P already contains the misfit, because the
 * posterior weights the data by 1/kappa^2, from the last refit on. Both variances are the sum of c' P c,
 * (s_g d(c' beta)/dg)^2 for the gain g of the torque, and a term for errors of phi, as in (F25). The variance of
 * sigma also contains the uncertainty of the slope near a knee. As an approximation, the share by which
 * errors of phi change sigma is also used for the torque.
 */
sh_real sh_point_evaluate(sh_point *point, const sh_coefficients *coefficients,
                          const sh_parameters *p, const sh_joint_point *at, int count,
                          const sh_variances *variances, const sh_phi_errors *errors)
{
    /* v sum 1/R: times V_phi, the share by which sigma is too small */
    const sh_real attenuation = errors->weights * variances->second;
    const sh_real gain = p->prior.torque_gain;
    const sh_real *beta = coefficients->beta, *per_gain = coefficients->per_gain;
    sh_real torque, torque_per_gain, stiffness, stiffness_per_gain;

    sh_scalar_products(at->F, beta, per_gain, count, &torque, &torque_per_gain);
    sh_scalar_products(at->dF, beta, per_gain, count, &stiffness, &stiffness_per_gain);
    point->tau_e = at->tau_nominal + torque;
    point->sigma = at->sigma_nominal + stiffness;
    point->tau_e_std = sh_std_deviation(
        variances->first + sh_square(gain * torque_per_gain) +
        of_errors(p, attenuation * point->tau_e, errors->rounding, variances->first));
    point->sigma_std = sh_std_deviation(
        variances->second + sh_square(gain * stiffness_per_gain) +
        of_errors(p, attenuation * point->sigma, errors->rounding, variances->second) +
        errors->knees);
    point->sigma_per_gain =
        sh_fabs(point->sigma) > 0
            ? sh_limited(stiffness_per_gain / sh_fabs(point->sigma), SH_LARGEST_OUTPUT)
            : 0;
    return stiffness_per_gain;
}
