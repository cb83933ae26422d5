/* A covariance P = U D U', U unit upper triangular and D diagonal. P itself is never formed. A positive entry of D
 * stays positive, so P stays positive definite whatever the data. Source: Bierman 1977, Factorization Methods for
 * Discrete Sequential Estimation, chapter V.
 *
 * Vectors F are [size: P->size]. Nothing behind their last entry is read.
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

/* Returns rho = F' P F, and prepares sh_ud_factor_update. */
sh_real sh_ud_factor_project(sh_ud_factor *P, const sh_real *F);

/* P -= P F (w / (1 + w rho)) F' P for the F and rho of sh_ud_factor_project, which must be the call
 * before: the covariance after a sample of weight w >= 0, P^-1 += w F F'.
 *
 * Returns P F of the P before, [size: P->size], valid until the next call.
 */
const sh_real *sh_ud_factor_update(sh_ud_factor *P, sh_real w);

/* F' P F, as a variance that is wanted and not as the begin of an update. */
sh_real sh_ud_factor_variance(const sh_ud_factor *P, const sh_real *F);

#endif
