/* Recursive least squares: standard (14), enhanced (25)-(27), and with a constant factor.
 *
 * With the weight w(k) of sample k, the recursion minimises
 *
 *     |eta - eta_0|^2 / P_0 + sum_k w(k) (y(k) - F(k)' eta)^2 .
 *
 * The three kinds of least squares differ only in the weight. (25) is
 *
 *     K = P F / (1 + rho) ,   eta += a K epsilon ,   P -= a K F' P ,
 *
 * which is the update for a sample of weight w = a / (1 + rho - a rho), because with it
 *
 *     a K = w P F / (1 + w rho) .
 *
 * This w is the left side of (26): 1 for (14), where a = 1, and exactly c for (27).
 */
#ifndef SH_LEAST_SQUARES_H
#define SH_LEAST_SQUARES_H

#include "sigmahat.h"

/* Quantities of one sample. All members but `variance` are computed before the update. */
typedef struct {
    sh_real epsilon;  /* prediction error, (14), in the unit of y */
    sh_real rho;      /* F' P F, (14) */
    sh_real a;        /* stability factor a(k), (27) */
    sh_real variance; /* F' P F after the update */
} sh_innovation;

/* Starts the recursion.
 *
 * size   number of parameters, 1..SH_MAX_PARAMETERS
 * eta_0  [size: size] initial estimate, NULL for zero
 * P_0    initial covariance, every diagonal entry, > 0
 */
void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0);

/* Updates the estimate with one sample, (25).
 *
 * kind    SH_RLS_*
 * factor  c of (27) for SH_RLS_ENHANCED, > 0; a for SH_RLS_CONSTANT_FACTOR, in
 *         [0, 1]; unused for SH_RLS_STANDARD
 * F       [size: size] regressor
 * y       torque that F' eta is fitted to [N.m]
 *
 * Returns 1, and sets innovation. Returns 0 if the sample is not finite, or so large that the update would overflow. In
 * this case, the estimate and innovation do not change.
 */
int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation);

/* Returns the variance F' P F. F [size: size] */
sh_real sh_least_squares_variance(const sh_least_squares *rls, const sh_real *F);

/* Moves the estimate: eta += c v. v [size: size] */
void sh_least_squares_move(sh_least_squares *rls, sh_real c, const sh_real *v);

#endif
