/* State-variable filter (point 2): low pass and derivatives of a sampled signal, without
 * differentiating it.
 *
 *     H(s) = (w / (s + w))^3 ,  s H(s)  and  s^2 H(s)
 *
 * Signals that all pass the same H keep their linear relations: a differential equation of second
 * order between measured signals becomes an algebraic equation between filtered signals, without a
 * lag between its terms. With the third order, s^2 H falls at high frequencies, so that little of
 * the rounding of an encoder passes. (Young 1981, Automatica 17:23-39; Garnier and Wang 2008,
 * Identification of Continuous-time Models from Sampled Data, chapter 1.)
 *
 * The filter is solved exactly for signals that are linear between samples. So at every frequency a
 * filtered derivative is the derivative of the filtered signal. Trapezoids (the bilinear
 * transformation) would make s^2 too large by the share (Omega T)^2 / 6.
 */
#ifndef SH_STATE_VARIABLE_FILTER_H
#define SH_STATE_VARIABLE_FILTER_H

#include "sigmahat.h"

/* Filter with the corner frequency w [rad/s] and the sample period T [s]. w T >= 1e-4: below,
 * digits are lost.
 */
sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T);

/* Starts the filter as if the signal had always been x: no transient. */
void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x);

/* Starts the filter at rest for a signal that was zero until now and jumps to x. */
void sh_state_variable_filter_begin(sh_state_variable_filter *filter, sh_real x);

/* Advances the filter by T, in which the signal went linearly to x. */
void sh_state_variable_filter_step(sh_state_variable_filter *filter, const sh_filter_design *design,
                                   sh_real x);

/* Advances the filter by T, in which the signal had the given mean. One filter takes only one of
 * the two kinds of steps.
 */
void sh_state_variable_filter_step_mean(sh_state_variable_filter *filter,
                                        const sh_filter_design *design, sh_real mean);

/* sum += share filter [size: count]: the outputs of a mean of states are the means of the outputs. */
void sh_state_variable_filter_add(sh_state_variable_filter *restrict sum,
                                  const sh_state_variable_filter *restrict filter, int count,
                                  sh_real share);

/* The filtered signal. */
sh_real sh_state_variable_filter_output(const sh_state_variable_filter *filter);

/* First and second derivative of the filtered signal, in its unit per s and per s2. */
sh_real sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design);
sh_real sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                        const sh_filter_design *design);

/* Variances that white noise of variance 1 has in the mean of samples 1.. behind H: gain [1], and behind
 * s^2 H: gain_second [1/s4].
 */
void sh_state_variable_filter_noise(const sh_filter_design *design, int samples, sh_real *gain,
                                    sh_real *gain_second);

#endif
