/* State-variable filter (point 2): low pass and derivatives of a sampled signal, without differentiating it,
 *
 *     H(s) = (w / (s + w))^3 ,  s H(s)  and  s^2 H(s) ,
 *
 * solved exactly for signals that are linear between samples. The filter is of third order, so that little of the
 * rounding of an encoder passes s^2 H. (Young 1981, Automatica 17:23-39; Garnier and Wang 2008, chapter 1.)
 */
#ifndef SH_STATE_VARIABLE_FILTER_H
#define SH_STATE_VARIABLE_FILTER_H

#include "sigmahat.h"

/* Filter with the corner frequency w [rad/s] and the sample period T [s]. w T >= 1e-4: below,
 * digits are lost.
 */
sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T);

/* Starts filter i for a signal that has always been `before` and jumps to x now. */
void sh_filters_start(sh_filters *filters, int i, sh_real x, sh_real before);

/* Gives filter i the mean of its signal until the next sample, if the signal is not linear between samples. Then
 * sh_filters_step follows, with this mean as x.
 */
void sh_filters_hold(sh_filters *filters, int i, sh_real mean);

/* Advances filters from the first one on by T, in which their signals go linearly to x [size: count]. */
void sh_filters_step(sh_filters *restrict filters, const sh_filter_design *design, int first,
                     const sh_real *restrict x, int count);

/* Lets the first filters rest if they are nearly at rest: processors compute slowly with the numbers to which they
 * would decay.
 */
void sh_filters_rest(sh_filters *filters, int count);

/* Sets the signals behind the filters. */
void sh_filters_read(const sh_filters *restrict filters, const sh_filter_design *design,
                     sh_filtered *restrict filtered);

/* Window h = 16 x^2 (1 - x)^2 at row k of a block of so many rows; 1 for a row alone. */
static inline sh_real sh_window(sh_real k, sh_real rows)
{
    const sh_real x = (k + (sh_real)0.5) / rows;

    return 16 * (x * (1 - x)) * (x * (1 - x));
}

/* Shares of white noise that H [1] and s^2 H [1/s4] leave in the mean over rows of K samples under this window. A share
 * is the energy of the filtered window over the energy of the window.
 */
void sh_state_variable_filter_noise(const sh_filter_design *design, sh_real rows, int K,
                                    sh_real *gain, sh_real *gain_second);

#endif
