/* The variance of a sample of the regression, whose inverse is its weight. */
#ifndef SH_SAMPLE_VARIANCE_H
#define SH_SAMPLE_VARIANCE_H

#include "sigmahat.h"

typedef struct {
    sh_real R;    /* variance of the sample [(N.m)2] */
    sh_real last; /* factor in R by errors that last, >= 1 */
} sh_sample_variance;

/* The variance: of the torque's noise, of the rounding of phi, and of friction of unknown sign, with
 * jitter of the sample times, and errors that last.
 */
sh_sample_variance sh_sample_variance_of(sh_regression_state *state, const sh_parameters *p);

/* Share of the torque's noise in the variance of the noise after the filter, 0..1; the rest is noise
 * of theta.
 */
sh_real sh_sample_variance_of_torque(const sh_regression_state *state, const sh_parameters *p);

/* Measures how much larger the noise after the filter is than what the rounding of theta explains.
 * Jitter of the sample times makes it larger.
 */
void sh_sample_variance_watch(sh_regression_state *state, const sh_parameters *p);

/* Information about b that is only rounding in this sample, times R; 0 without a column of b. */
sh_real sh_sample_variance_of_inertia(const sh_regression_state *state, const sh_parameters *p);

/* Variance of the rounding of phi that is left after the filter, if it is white [rad2]. */
sh_real sh_sample_variance_of_deformation(const sh_regression_state *state);

/* Whether the prediction error of a sample shows, at the start, that the motor was not at rest.
 *
 * x  [size: state->size + SH_SIDES] row of the sample
 */
int sh_sample_variance_contradicts_rest(sh_regression_state *state, const sh_parameters *p,
                                        const sh_real *x);

#endif
