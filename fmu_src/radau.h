/* Integrates the generated equations of a plant (plant_functions.h) by the L-stable method Radau IIA with three stages
 * and order 5. Hairer and Wanner describe the method in "Solving Ordinary Differential Equations II", section IV.8.
 *
 * Inputs are linear in time: u + du s, where s is the time since the start. Array sizes: x [size: states],
 * u and du [size: inputs], p [size: parameters].
 */
#ifndef SH_RADAU_H
#define SH_RADAU_H

/* Integrates the state x over `duration` > 0 in several steps. The allowed error of a state x at the end is
 * 1e-8 (scale + |x|), where the plant defines the scale. A motion that decays before the end is only resolved as far as
 * this motion changes x at the end.
 *
 * On input, *h is the step length to try first, or infinite if unknown. On output, *h is the step length that the next
 * call should try first.
 *
 * Returns the number of steps. Returns 0 if even a negligibly short step has a too large error, or after
 * sh_radau_attempts(duration) attempts. After a failure, x is the state after the last accepted step.
 */
int sh_radau_integrate(double *x, const double *u, const double *du, const double *p,
                       double duration, double *h);

/* Largest number of attempted steps: 10000 for a transient plus one for each microsecond of the duration, but at most
 * a million. Only an unrealistically fast joint needs more attempts.
 */
int sh_radau_attempts(double duration);

#endif
