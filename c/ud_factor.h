/* A covariance P = U D U', U unit upper triangular and D diagonal. P itself is never
 * formed. An entry of D that is positive stays positive, so P stays positive definite whatever the
 * data (Bierman 1977, Factorization Methods for Discrete Sequential Estimation, chapter V).
 *
 * Vectors F and v are [size: P->size]. Nothing behind their last entry is read.
 */
#ifndef SH_UD_FACTOR_H
#define SH_UD_FACTOR_H

#include "sigmahat.h"

/* Sets P = P_0 I.
 *
 * size  number of parameters, 1..SH_MAX_PARAMETERS
 * P_0   > 0
 */
void sh_ud_factor_start(sh_ud_factor *P, int size, sh_real P_0);

/* Sets the variance of parameter i, >= 0, directly after the start. 0: the parameter is known. */
void sh_ud_factor_set_variance(sh_ud_factor *P, int i, sh_real variance);

/* Returns rho = F' P F, and prepares sh_ud_factor_update. */
sh_real sh_ud_factor_project(sh_ud_factor *P, const sh_real *F);

/* P -= P F (w / (1 + w rho)) F' P for the F and rho of sh_ud_factor_project, which must be the call
 * before: the covariance after a sample of weight w >= 0, P^-1 += w F F'.
 *
 * Returns P F of the P before, [size: P->size], valid until the next call.
 */
const sh_real *sh_ud_factor_update(sh_ud_factor *P, sh_real w);

/* F' P F, as a variance that is wanted and not as the begin of an update. */
sh_real sh_ud_factor_variance(sh_ud_factor *P, const sh_real *F);

/* P += c v v', c >= 0 (Agee and Turner 1972). */
void sh_ud_factor_widen(sh_ud_factor *P, sh_real c, const sh_real *v);

/* P += c v v' for v = column i of P, c >= 0. Cheap for the last columns. */
void sh_ud_factor_widen_column(sh_ud_factor *P, sh_real c, int i);

/* Column i of P, [size: P->size], valid until the next call. Cheap for the last columns. */
const sh_real *sh_ud_factor_column(sh_ud_factor *P, int i);

/* If the variance of parameter i is above P_max, scales it to P_max. Correlations do not change. */
void sh_ud_factor_bound(sh_ud_factor *P, int i, sh_real P_max);

/* Entry (i, j) of P, 0 <= i, j < P->size. */
sh_real sh_ud_factor_entry(const sh_ud_factor *P, int i, int j);

#endif
