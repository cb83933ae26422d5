/* Regression of the method MatchedFilter: the flexibility torque and the errors of the motor data
 * in one regression, from signals that all passed the same filter.
 *
 * Take the motor (3) with Coulomb friction, and let its data B and D_theta have the relative errors
 * b and d:
 *
 *     (1+b) B gamma theta'' + (1+d) D_theta gamma theta' + tau_C sign(theta')
 *         - tau_e / gamma = tau .
 *
 * With both sides through H(s) (state_variable_filter.h, index f) and with tau_e = F' eta of (21),
 * this is the regression
 *
 *     y = gamma (B gamma theta''_f + D_theta gamma theta'_f - tau_f)
 *       = F_f' eta - gamma^2 D_theta theta'_f d - gamma^2 B theta''_f b
 *         - |gamma| sign(theta')_f tau_C .
 *
 * If the flexibility torque is measured (SH_MODALITY_SENSOR) or modelled (SH_MODALITY_MODEL), y is
 * that torque through H, and the columns of the motor data are zero.
 *
 * Priors and noise are in sh_parameters: prior.*, noise.*. A prior of 0 removes its column.
 */
#ifndef SH_MATCHED_REGRESSION_H
#define SH_MATCHED_REGRESSION_H

#include "least_squares.h"

/* Columns and coefficients d, b and tau_C: their places behind the coefficients of the torque. */
enum { SH_MOTOR_D_THETA = 0, SH_MOTOR_B = 1, SH_MOTOR_COULOMB = 2 };

/* Starts regression and recursion.
 *
 * eta_0  [size: rls.n rls.m] prior mean of the coefficients of the torque [N.m]
 */
void sh_matched_start(sh_matched_regression *matched, sh_least_squares *rls, const sh_parameters *p,
                      const sh_real *eta_0);

/* Lets the filters start again with the next sample, and the recursion wait until they have
 * settled. For use after samples were lost; the estimate does not change.
 */
void sh_matched_resume(sh_matched_regression *matched, const sh_parameters *p);

/* Takes one sample.
 *
 * theta       position of the motor [rad]
 * torque      motor torque, or the measured or modelled flexibility torque [N.m]
 * phi         measured deformation [rad]
 * sigma       last estimate of the stiffness, by which rounding of phi is torque [N.m/rad]
 * F           [size: rls.n rls.m] regressor of the torque
 * y           out: y of the regression [N.m]
 * innovation  out: epsilon [N.m]; rho, the variance of the prediction over that of the sample [1];
 *             a, 1 if the recursion took the sample, 0 if the filters have not settled
 *
 * Returns 1. Returns 0, without any change of the recursion, if the numbers are too large.
 */
int sh_matched_step(sh_matched_regression *matched, sh_least_squares *rls, const sh_parameters *p,
                    sh_real theta, sh_real torque, sh_real phi, sh_real sigma, const sh_real *F,
                    sh_real *y, sh_innovation *innovation);

/* The estimate of all parameters: that of the recursion, with the correct weight of the information
 * about b, see sh_rounding_bias_estimate.
 *
 * dF   [size: rls->P.size] a combination of parameters
 * eta  [size: rls->P.size] out: the estimate
 *
 * Returns the variance of dF' eta.
 */
sh_real sh_matched_estimate(const sh_matched_regression *matched, sh_least_squares *rls,
                            const sh_parameters *p, const sh_real *dF, sh_real *eta);

#endif
