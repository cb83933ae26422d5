/* Integration of the generated equations of a plant (plant_functions.h): Radau IIA with three
 * stages, order 5, L-stable; Hairer, Wanner, "Solving Ordinary Differential Equations II", section
 * IV.8.
 *
 * Inputs are linear in time: u + du s, with s the time since the start. Arrays: x [size: states],
 * u and du [size: inputs], p [size: parameters].
 */
#ifndef SH_RADAU_H
#define SH_RADAU_H

/* Advances x by duration > 0 in steps. The allowed error at the end is 1e-8 (scale + |x|) for each state, with the
 * scale of the plant. A motion that decays before the end is
 * resolved only as far as this motion changes x at the end.
 *
 * *h in: the step to try first, infinite if unknown; out: the step to try first after this
 * duration.
 *
 * Returns the number of steps. Returns 0 if the error of even a negligible step is too large, or after
 * sh_radau_attempts(duration) attempts. Then x is the state after the last good step.
 */
int sh_radau_integrate(double *x, const double *u, const double *du, const double *p,
                       double duration, double *h);

/* Largest number of attempted steps in a duration: 10000 for a transient, and one for each
 * microsecond of the duration, but a million in all. Only an absurdly fast joint needs more.
 */
int sh_radau_attempts(double duration);

#endif
