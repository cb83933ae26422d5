/* State-variable filter (point 2): low pass and derivatives of a sampled signal, without differentiating it,
 *
 *     H(s) = (w / (s + w))^3 ,  s H(s)  and  s^2 H(s) ,
 *
 * solved exactly for signals that are linear between samples. Of third order, so that little of the rounding of
 * an encoder passes s^2 H. (Young 1981, Automatica 17:23-39; Garnier and Wang 2008, chapter 1.)
 */
#ifndef SH_STATE_VARIABLE_FILTER_H
#define SH_STATE_VARIABLE_FILTER_H

#include "sigmahat.h"

/* Filter with the corner frequency w [rad/s] and the sample period T [s]. w T >= 1e-4: below,
 * digits are lost.
 */
sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T);

/* Starts the filter for a signal that has always been `before` and jumps to x now. */
void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x, sh_real before);

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

/* The same for the filters of the columns: starts the one of column i, and advances all to x [size: count], linearly.
 * Their outputs are added to a sum [size: count].
 */
void sh_column_filters_start(sh_column_filters *filters, sh_real *sum, int i, sh_real x,
                             sh_real before);
void sh_column_filters_step(sh_column_filters *restrict filters, sh_real *restrict sum,
                            const sh_filter_design *design, const sh_real *restrict x, int count);

/* Lets those rest that are as good as at rest: processors compute slowly with the numbers to which they would decay. */
void sh_column_filters_rest(sh_column_filters *filters, int count);

/* The filtered signal. */
sh_real sh_state_variable_filter_output(const sh_state_variable_filter *filter);

/* First and second derivative of the filtered signal, in its unit per s and per s2. */
sh_real sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design);
sh_real sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                        const sh_filter_design *design);

/* Window h = 16 x^2 (1 - x)^2 at row k of a block of so many rows; 1 for a row alone. */
static inline sh_real sh_window(sh_real k, sh_real rows)
{
    const sh_real x = (k + (sh_real)0.5) / rows;

    return 16 * (x * (1 - x)) * (x * (1 - x));
}

/* Shares of white noise that H [1] and s^2 H [1/s4] leave in the mean over rows of K samples under this window:
 * the energy of the filtered window over that of the window.
 */
void sh_state_variable_filter_noise(const sh_filter_design *design, sh_real rows, int K,
                                    sh_real *gain, sh_real *gain_second);

#endif
