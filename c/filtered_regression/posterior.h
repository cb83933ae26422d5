/* What is known of the parameters: their prior, and the data weighted by the misfit.
 *
 * A posterior uses a choice of the columns of the data. The last one of an estimate is that of the error b of
 * the inertia, if there is one. So the last entry of D is the information about b, and what is rounding in it
 * (point 4, detail 7) is removed in O(1).
 */
#ifndef SH_POSTERIOR_H
#define SH_POSTERIOR_H

#include "information.h"

/* Takes a sample of the weight w times the weight of the posterior.
 *
 * x     row of the sample, with all columns, then the right-hand sides
 * size  number of all columns
 *
 * Returns 1 / (1 + rho), where rho is the variance of the prediction over the one of the sample.
 */
sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w);

/* Adds information [1] about b that is only rounding, and removes as much as possible: b does not become
 * less certain than its prior.
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

/* Two combinations [size: count] of the coefficients of the first columns of the data; found [size: 2]. */
void sh_posterior_combine(const sh_posterior *posterior, sh_real prior_B, const sh_real *first,
                          const sh_real *second, int count, sh_combination *found);

/* Variance of one of them. */
sh_real sh_posterior_variance(const sh_posterior *posterior, sh_real prior_B, const sh_real *c,
                              int count);

#endif
