/* State-variable filter: low pass and derivatives of a sampled signal, without
 * differentiating it.
 *
 *     H(s) = (w / (s + w))^3 ,  s H(s)  and  s^2 H(s)
 *
 * Whatever passes the same H keeps its linear relations: a differential equation
 * of second order between measured signals becomes an algebraic one between
 * filtered signals, without lag between its terms. The third order makes s^2 H
 * roll off, so that little of the rounding of an encoder comes through. (Young
 * 1981, Automatica 17:23-39; Garnier and Wang 2008, Identification of
 * Continuous-time Models from Sampled Data, chapter 1.)
 *
 * The filter is solved exactly for signals that are linear between samples. So
 * a derivative is the true derivative of what the other signals show at every
 * frequency, while trapezoids (bilinear) make s^2 too large by (Omega T)^2 / 6.
 */
#ifndef SH_STATE_VARIABLE_FILTER_H
#define SH_STATE_VARIABLE_FILTER_H

#include "real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What all filters of one corner and sample period share. */
typedef struct {
    sh_real w;       /* corner [rad/s] */
    sh_real T;       /* sample period [s] */
    sh_real lag;     /* 1 / (w T), by which a stage runs behind a ramp [samples] */
    sh_real keep[3]; /* what a stage keeps of its own deviation, and of those one and two stages
                        before it, after T */
} sh_filter_design;

/* State of the filter of one signal, in the signal's unit. */
typedef struct {
    sh_real input;     /* last sample */
    sh_real behind[3]; /* input less output of each stage: small, so that derivatives keep their
                          digits however far the signal is from zero */
} sh_state_variable_filter;

/* Filter with corner w [rad/s] and sample period T [s]; w T from 1e-4 on, below which digits
 * are lost.
 */
sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T);

/* Starts the filter as if the signal had been x for ever: no transient. */
void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x);

/* Starts the filter at rest for a signal that begins now with x and was zero before. */
void sh_state_variable_filter_begin(sh_state_variable_filter *filter, sh_real x);

/* Advances the filter by T; the signal went linearly to x. */
void sh_state_variable_filter_step(sh_state_variable_filter *filter, const sh_filter_design *design,
                                   sh_real x);

/* The same for a signal of which only the mean over T is known. Do not mix the two. */
void sh_state_variable_filter_step_mean(sh_state_variable_filter *filter,
                                        const sh_filter_design *design, sh_real mean);

/* The filtered signal. */
sh_real sh_state_variable_filter_output(const sh_state_variable_filter *filter);

/* First and second derivative of the filtered signal [1/s, 1/s2]. */
sh_real sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design);
sh_real sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                        const sh_filter_design *design);

/* Noise gain of the second derivative: variance of s^2 H x [1/s4] for white samples x of
 * variance 1.
 */
sh_real sh_state_variable_filter_noise(const sh_filter_design *design);

#ifdef __cplusplus
}
#endif
#endif
