/* Recursive least squares, standard (14), enhanced (25)-(27) and with constant
 * factor, as one weighted recursion in UD factors.
 *
 * With the weight w(k) of a sample, the recursion minimises
 *
 *     |eta - eta_0|^2 / P_0 + sum_k w(k) (y(k) - F(k)' eta)^2 .
 *
 * The three kinds differ in the weight alone: a / (1 + rho - a rho), which is 1
 * for (14) and exactly c for (27). P = U D U' is never formed; its diagonal
 * factor D stays positive by construction, so P stays positive definite
 * whatever the data (Bierman 1977, Factorization Methods for Discrete
 * Sequential Estimation, chapter V).
 */
#ifndef SH_LEAST_SQUARES_H
#define SH_LEAST_SQUARES_H

#include "torque_basis.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SH_RLS_ENHANCED = 1,       /* a(k) of (27) */
    SH_RLS_STANDARD = 2,       /* a = 1, (14) */
    SH_RLS_CONSTANT_FACTOR = 3 /* a as given, in (25) */
};

enum {
    SH_MAX_MOTOR = 3, /* errors of motor data that are estimated with the torque */
    SH_MAX_PARAMETERS = SH_MAX_BASIS + SH_MAX_MOTOR
};
enum {
    SH_PANEL = 4, /* rows of U side by side in memory */
    SH_MAX_ROWS = (SH_MAX_PARAMETERS + SH_PANEL - 1) / SH_PANEL * SH_PANEL,
    SH_MAX_U = SH_MAX_ROWS * SH_MAX_PARAMETERS - SH_MAX_ROWS * (SH_MAX_ROWS - SH_PANEL) / 2 +
        SH_PANEL /* one more column: it is read with the last ones, and not used */
};

/* State of the recursion. */
typedef struct {
    sh_real eta[SH_MAX_ROWS];     /* estimate */
    sh_real eta_low[SH_MAX_ROWS]; /* what rounding left out of eta: millions of
                                     small updates must not add up to an error */
    sh_real D[SH_MAX_ROWS];       /* diagonal factor of P, > 0 */
    sh_real U[SH_MAX_U];          /* unit upper triangular factor of P, in panels of SH_PANEL
                                     rows: from the diagonal on, column after column, with
                                     the ones and zeros of the triangle */
    struct {
        sh_real pairs[SH_MAX_ROWS][2];
        sh_real F[SH_MAX_ROWS], f[SH_MAX_ROWS], rho[SH_MAX_ROWS + 1];
    } work;   /* means nothing between calls; here to spare the stack */
    int size; /* number of parameters, 1..SH_MAX_PARAMETERS */
} sh_least_squares;

/* What one sample did, all of it from before the update. */
typedef struct {
    sh_real epsilon; /* prediction error, (14), in the unit of y */
    sh_real rho;     /* F' P F, (14) */
    sh_real a;       /* stability factor a(k), (27) */
} sh_innovation;

/* Starts the recursion.
 *
 * size   number of parameters, 1..SH_MAX_PARAMETERS
 * eta_0  [size: size] initial estimate, NULL for zero
 * P_0    initial covariance, every diagonal entry, > 0
 */
void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0);

/* Takes one sample, (25).
 *
 * kind    SH_RLS_*
 * factor  c of (27) for SH_RLS_ENHANCED, > 0; a for SH_RLS_CONSTANT_FACTOR, in
 *         (0, 1]; unused for SH_RLS_STANDARD
 * F       [size: size] regressor
 * y       torque that F' eta is to meet [N.m]
 *
 * Returns 1, and fills innovation. Returns 0 and leaves state and innovation
 * as they were if the sample is not finite or so large that the update would
 * overflow.
 */
int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation);

/* Takes one sample with a given weight: P^-1 += w F F'.
 *
 * w        one over the variance of the noise of y, >= 0
 * epsilon  prediction error before the update, as in sh_innovation
 *
 * F, y and the returned value as for sh_least_squares_update.
 */
int sh_least_squares_weigh(sh_least_squares *rls, sh_real w, const sh_real *F, sh_real y,
                           sh_real *epsilon, sh_real *rho);

/* Prior variance of parameter i alone, >= 0; 0 keeps it at its eta_0. Between start and the
 * first sample.
 */
void sh_least_squares_prior(sh_least_squares *rls, int i, sh_real variance);

/* Widens the covariance: P += c v v', c >= 0 (Agee and Turner 1972). v [size: size]. */
void sh_least_squares_widen(sh_least_squares *rls, sh_real c, const sh_real *v);

/* Shrinks the variance of parameter i to P_max if it is above; correlations stay. */
void sh_least_squares_bound(sh_least_squares *rls, int i, sh_real P_max);

/* The same along column i of P; cheap for the last ones. */
void sh_least_squares_widen_column(sh_least_squares *rls, sh_real c, int i);

/* Column i of P [size: size]; cheap for the last ones. It is kept at work: the next call of any
 * other function but sh_least_squares_move writes over it.
 */
const sh_real *sh_least_squares_column(sh_least_squares *rls, int i);

/* Moves the estimate: eta += c v. v [size: size]. */
void sh_least_squares_move(sh_least_squares *rls, sh_real c, const sh_real *v);

/* F' P F [unit of y squared over noise variance] for a vector F [size: size]. Changes nothing
 * but what is at work.
 */
sh_real sh_least_squares_variance(sh_least_squares *rls, const sh_real *F);

/* Entry (i, j) of P, 0 <= i, j < size. */
sh_real sh_least_squares_covariance(const sh_least_squares *rls, int i, int j);

#ifdef __cplusplus
}
#endif
#endif
