/* A covariance P = U D U', U unit upper triangular and D diagonal. The matrix P is never computed. A positive entry of
 * D stays positive, so P stays positive definite for all data. Source: Bierman 1977, Factorization Methods for Discrete
 * Sequential Estimation, chapter V.
 *
 * A vector F has P->size entries, and the functions read no number behind the last entry of F.
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

/* P -= P F (w / (1 + w rho)) F' P: updates the covariance with a sample of weight w >= 0, so that P^-1 += w F F'. F and
 * rho are from the previous call, which must be sh_ud_factor_project.
 *
 * Returns the vector P F [size: P->size] with P from before the update. The vector is valid until the next call.
 */
const sh_real *sh_ud_factor_update(sh_ud_factor *P, sh_real w);

/* Returns the variance F' P F. Unlike sh_ud_factor_project, this function does not prepare an update. */
sh_real sh_ud_factor_variance(const sh_ud_factor *P, const sh_real *F);

#endif
