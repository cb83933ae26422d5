/* The filters of the method FilteredRegression: all signals of the regression pass the same H. */
#ifndef SH_SIGNALS_H
#define SH_SIGNALS_H

#include "sigmahat.h"

/* Time constants 1/w after which a filter has forgotten its start. */
#define SH_FORGOTTEN ((sh_real)12)

/* Corner frequency of the filters [rad/s]: regression.bandwidth, but at most 1.42 W_c (and at least
 * 1e-4 / samplePeriod), where
 * W_c = sqrt(noise.tau / (B |gamma| s)) is the frequency at which the noise of the torque and the
 * rounding of theta, of std deviation s, contribute equally to y. Above it the noise of y is not
 * white, and the weights of the samples would be wrong.
 */
sh_real sh_regression_bandwidth(const sh_parameters *p);

/* Designs the filters, which start with the next sample. */
void sh_signals_start(sh_regression_state *state, const sh_parameters *p);

/* Lets the filters start again with the next sample, and the estimate wait until they have settled.
 */
void sh_signals_resume(sh_regression_state *state);

/* Lets the estimate wait until the filters have settled: they did not start at rest. */
void sh_signals_unsettle(sh_regression_state *state);

/* Takes a sample; the signals of the columns are in work.F.
 *
 * theta   position of the motor [rad]
 * torque  motor torque, or the measured or modelled flexibility torque [N.m]
 */
void sh_signals_step(sh_regression_state *state, const sh_parameters *p, sh_real theta,
                     sh_real torque);

/* Takes the deformation [rad] of a sample: range, elements of hysteresis, and how long it rests. To
 * be called before sh_columns_input.
 */
void sh_signals_deform(sh_regression_state *state, const sh_parameters *p, sh_real phi);

/* Mean square of the rounding and jitter of theta, from the fourth difference of its last samples:
 * that of white noise of variance 1 has the variance 70 [rad2].
 */
sh_real sh_signals_roughness(const sh_regression_state *state);

#endif
