/* What is known of the parameters: their priors, and the data weighted by the misfit.
 *
 * A posterior uses a choice of the columns of the data: those of group 0, and those of the groups
 * that the data ask for. The column of the inertia error b is its last one. Then the last entry of D
 * is the information about b, and it can be changed in O(1). This is used for the rounding of theta:
 *
 * The column x of b contains rounding noise of variance V, and y contains the same noise times
 * 1 + b. So the sum of squares that least squares minimise contains V (1 + b)^2 for every sample,
 * and the estimate is biased towards b = -1 (attenuation; Soderstrom 2007, Errors-in-variables
 * methods in system identification, Automatica 43:939-958). V is known, so this part N of the
 * information is removed, as far as b does not become less certain than its prior.
 *
 * What remains is an equation I b = s for b, in which the other parameters are eliminated. It is
 * unbiased, but the variance of s is I + N + Q, where Q is the variance of N / prior.B: of its
 * noise, and of 5 % by which rounding may differ from its model. So the data have the information
 * I^2 / (I + N + Q), by which the estimate is computed. The other parameters keep their
 * distribution for a given b.
 */
#ifndef SH_POSTERIOR_H
#define SH_POSTERIOR_H

#include "sigmahat.h"

/* Chooses the columns and starts from the prior.
 *
 * trial   group of columns that are put behind all others, so that they can be judged; 0: none
 * weight  of the data, one over the variance factor of the misfit, 0..1
 */
void sh_posterior_start(const sh_regression_state *state, const sh_parameters *p,
                        sh_posterior *posterior, int trial, sh_real weight);

/* to = from, as far as it is used. */
void sh_posterior_copy(sh_posterior *to, const sh_posterior *from);

/* Takes a sample of the weight w times that of the posterior.
 *
 * x    [size: state->size + SH_SIDES] its row, with all columns
 * row  [size: SH_MAX_ENTRIES] memory; afterwards the entry behind the sides of the posterior's own
 *      columns is the prediction error of y
 *
 * Returns 1 / (1 + rho), where rho is the variance of the prediction over that of the sample.
 */
sh_real sh_posterior_take(const sh_regression_state *state, sh_posterior *posterior,
                          const sh_real *x, sh_real w, sh_real *row);

/* Adds information [1] about b that is only rounding, and removes as much as possible.
 *
 * prior_B  relative std deviation of B, > 0
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real information, sh_real prior_B);

/* The stiffness, and how uncertain it is. */
typedef struct {
    sh_real variance; /* of sigma, without the gain of the torque [(N.m/rad)2] */
    sh_real by_gain;  /* change of sigma with the relative gain of the torque [N.m/rad] */
} sh_stiffness_fit;

/* Computes the estimate beta of all columns, and how uncertain the stiffness is at the slopes in
 * work.dF.
 */
sh_stiffness_fit sh_posterior_evaluate(sh_regression_state *state, sh_posterior *posterior);

/* Variance of a combination c [size: of the posterior] of its parameters.
 *
 * v  [size: of the posterior] memory
 */
sh_real sh_posterior_variance(const sh_posterior *posterior, const sh_real *c, sh_real *v);

#endif
