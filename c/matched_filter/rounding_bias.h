/* What the rounding of an encoder does to a parameter whose regressor contains it, and how this is
 * corrected.
 *
 * Let the column x of the parameter contain noise of variance V, and let y contain the same noise
 * times 1 + b, where b is the parameter. Then the sum of squares that least squares minimise
 * contains V (1 + b)^2 for every sample, and the estimate is biased towards b = -1 (attenuation;
 * Soderstrom 2007, Errors-in-variables methods in system identification, Automatica 43:939-958).
 * The rounding of an encoder has a known variance, so this term can be removed.
 */
#ifndef SH_ROUNDING_BIAS_H
#define SH_ROUNDING_BIAS_H

#include "sigmahat.h"

/* Removes the surplus from the recursion, from its information and from its estimate, as far as P
 * allows it: the variance of the parameter does not grow above its prior variance, and P stays
 * positive definite. What is left stays in bias->surplus.
 *
 * at              which parameter is b
 * prior_variance  its prior variance, > 0; its prior mean is 0
 */
void sh_rounding_bias_remove(sh_rounding_bias *bias, sh_least_squares *rls, int at,
                             sh_real prior_variance);

/* The estimate with the correct weight of the data for b, see rounding_bias.c.
 *
 * dF   [size: rls->P.size] a combination of parameters
 * eta  [size: rls->P.size] out: estimate of all parameters
 *
 * Returns the variance of dF' eta.
 */
sh_real sh_rounding_bias_estimate(const sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                  sh_real prior_variance, const sh_real *dF, sh_real *eta);

#endif
