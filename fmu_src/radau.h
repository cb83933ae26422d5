/* Integration of the generated equations of a plant (plant_functions.h): Radau IIA
 * with three stages, order 5, L-stable; Hairer, Wanner, "Solving Ordinary
 * Differential Equations II", section IV.8.
 *
 * Inputs are linear in time, u + du s at s after the begin. Arrays: x [size: states],
 * u and du [size: inputs], p [size: parameters].
 */
#ifndef SH_RADAU_H
#define SH_RADAU_H

/* One step of length h > 0 from x to x_new, without error control.
 *
 * Returns the estimated error as a multiple of what is allowed, the largest over
 * the states; infinite or not a number if there is no solution. Allowed is
 * 1e-8 (scale + |x|), with the scale that the plant gives for each state.
 */
double sh_radau_step(const double *x, const double *u, const double *du, const double *p, double h,
                     double *x_new);

/* Advances x by duration > 0 in steps that keep to the allowed error at its end: what dies out
 * before is followed only as far as it matters then.
 *
 * *h is the step to try first and, after it, the step that suits what follows;
 * infinite if nothing is known. Returns the number of steps; 0 if even a
 * negligible step does not keep to the error, or after a million attempts, and
 * x is then where that was.
 */
int sh_radau_integrate(double *x, const double *u, const double *du, const double *p,
                       double duration, double *h);

#endif
