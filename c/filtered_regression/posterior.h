/* What is known of the parameters: their prior, and the data weighted by the misfit.
 *
 * A posterior uses a choice of the columns of the data. The column of the inertia error b is its last
 * one, except in a trial, so the last entry of D is the information about b, and can be changed in O(1). This is used for
 * the rounding of theta (point 4, detail 7):
 *
 * The column of b contains rounding noise of variance V, and y contains the same noise times 1 + b. So
 * the sum of squares that least squares minimise contains V (1 + b)^2 for every sample, and the
 * estimate is biased towards b = -1 (Soderstrom 2007, Errors-in-variables methods in system
 * identification, Automatica 43:939-958). V is known, so this part N of the information is removed, as
 * far as b does not become less certain than its prior. What remains is an equation I b = s without
 * bias, but the variance of s is I + N + Q, where Q is the variance of N. So the data have the
 * information I^2 / (I + N + Q).
 */
#ifndef SH_POSTERIOR_H
#define SH_POSTERIOR_H

#include "information.h"

/* Starts from the prior with the columns chosen [size: size].
 *
 * columns  of the data
 * weight   of the data, one over the variance factor of the misfit, 0..1
 */
void sh_posterior_start(sh_posterior *posterior, const sh_columns *columns, const int *chosen,
                        int size, sh_real weight);

/* to = from, as far as it is used. */
void sh_posterior_copy(sh_posterior *to, const sh_posterior *from);

/* Takes a sample of the weight w times the weight of the posterior.
 *
 * x     row of the sample, with all columns, then the right-hand sides
 * size  number of all columns
 *
 * Returns 1 / (1 + rho), where rho is the variance of the prediction over the one of the sample.
 */
sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w);

/* Adds information [1] about b that is only rounding, and removes as much as possible.
 *
 * prior_B  relative std deviation of B, > 0
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real information, sh_real prior_B);

/* Removes the noise in a column (detail 14), as far as its coefficient does not become less
 * certain than its prior.
 *
 * i      place of the column among those of the posterior
 * noise  of the samples, each with its weight, but without the weight of the posterior
 */
void sh_posterior_remove_noise(sh_posterior *posterior, sh_real prior_B, int i,
                               const sh_column_noise *noise);

/* The estimate beta [size: size] of all columns; 0 for those that are not used. */
void sh_posterior_estimate(const sh_posterior *posterior, sh_real prior_B, sh_real *beta, int size);

/* A combination c [size: all columns] of the coefficients. */
sh_combination sh_posterior_combine(const sh_posterior *posterior, sh_real prior_B,
                                    const sh_real *c);

#endif
