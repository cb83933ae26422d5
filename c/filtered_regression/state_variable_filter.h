/* State-variable filter (F2): low pass and derivatives of a sampled signal, without numerical differentiation,
 *
 *     H(s) = (w / (s + w))^3 ,  s H(s)  and  s^2 H(s) ,
 *
 * solved exactly for signals that are linear between samples. The filter is of third order, so that little of the
 * rounding of an encoder passes s^2 H. (Young 1981, Automatica 17:23-39; Garnier and Wang 2008, chapter 1.)
 */
#ifndef SH_STATE_VARIABLE_FILTER_H
#define SH_STATE_VARIABLE_FILTER_H

#include "sigmahat.h"

/* Designs a filter with the corner frequency w [rad/s] and the sample period T [s]. w T < 1e-4 would lose digits. */
sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T);

/* Starts filter i for a signal that has always been `before` and jumps to x now. */
void sh_filters_start(sh_filters *filters, int i, sh_real x, sh_real before);

/* Gives filter i the mean of the signal until the next sample, if the signal is not linear between samples. The next
 * call must be sh_filters_step with this mean as x.
 */
void sh_filters_hold(sh_filters *filters, int i, sh_real mean);

/* Advances `count` filters by T, beginning with filter `first`. Their signals change linearly to x [size: count]. */
void sh_filters_step(sh_filters *restrict filters, const sh_filter_design *design, int first,
                     const sh_real *restrict x, int count);

/* Sets filter states that are nearly 0 to 0, because processors compute slowly with still smaller numbers. */
void sh_filters_rest(sh_filters *filters, int count);

/* Computes the output signals of the filters and their derivatives. */
void sh_filters_read(const sh_filters *restrict filters, const sh_filter_design *design,
                     sh_filtered *restrict filtered);

/* Returns the window h = 16 x^2 (1 - x)^2 at row k of a block of `rows` rows; 1 for a block of one row. */
static inline sh_real sh_window(sh_real k, sh_real rows)
{
    const sh_real x = (k + (sh_real)0.5) / rows;

    return 16 * (x * (1 - x)) * (x * (1 - x));
}

/* Computes the shares of white noise that H [1] and s^2 H [1/s4] leave in the windowed mean of rows of K samples. A
 * share is the energy of the filtered window divided by the energy of the window.
 */
void sh_state_variable_filter_noise(const sh_filter_design *design, sh_real rows, int K,
                                    sh_real *gain, sh_real *gain_second);

#endif
