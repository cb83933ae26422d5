/* What the rounding of an encoder does to a parameter whose regressor it is in,
 * and to what is believed of that parameter.
 *
 * With a noise of variance V in a column x and, multiplied by the same true
 * parameter 1 + b, in y, the sum of squares that least squares minimise holds
 * V (1 + b)^2 for every sample: the fit is pulled towards b = -1 (attenuation;
 * Soderstrom 2007, Errors-in-variables methods in system identification,
 * Automatica 43:939-958). The rounding of an encoder has a known variance.
 */
#ifndef SH_ROUNDING_BIAS_H
#define SH_ROUNDING_BIAS_H

#include "least_squares.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Information about the parameter that is rounding and no information [1]. */
typedef struct {
    sh_real surplus; /* still in the recursion */
    sh_real taken;   /* taken back so far */
} sh_rounding_bias;

/* Takes the surplus out of the recursion, information and pull alike, as far as P can bear it:
 * the parameter is never left less known than its prior says, and P stays positive definite.
 *
 * at              which parameter is b
 * prior_variance  its prior variance, > 0; its prior mean is 0
 */
void sh_rounding_bias_take_back(sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                sh_real prior_variance);

/* What is believed of a combination of parameters: estimate and variance.
 *
 * dF   [size: rls->size] the combination
 * eta  [size: rls->size] out: estimate of all parameters
 *
 * Returns the variance of dF' eta.
 */
sh_real sh_rounding_bias_belief(const sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                sh_real prior_variance, const sh_real *dF, sh_real *eta);

#ifdef __cplusplus
}
#endif
#endif
