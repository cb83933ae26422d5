/* Separable polynomial basis of the flexibility torque, (18)-(23).
 *
 * The symmetric basis is the basis of the paper: odd powers of the deformation, for a torque that is an odd function of
 * the deformation, (16). The general basis has all powers from 0 on, for transmissions that are softer to one side or
 * have an offset.
 */
#ifndef SH_TORQUE_BASIS_H
#define SH_TORQUE_BASIS_H

#include "sigmahat.h"

/* Regressor F of (22) and its derivative by the deformation, (23).
 *
 * symmetric  1: powers e_i = 2i + 1 of phi, as in (18); 0: e_i = i
 * n, m       orders, 1..SH_MAX_N and 1..SH_MAX_M
 * set_point  l: stands for theta_c in (19); for the AwAS the lever arm in mm
 * phi        deformation [rad]
 * F          [size: n m] F[j n + i] = l^j phi^(e_i)
 * dF         [size: n m] dF[j n + i] = e_i l^j phi^(e_i - 1)
 *
 * The torque (21) is F' eta, and the stiffness (23) is dF' eta. The entries of eta have the order of F.
 */
void sh_torque_basis(int symmetric, int n, int m, sh_real set_point, sh_real phi,
                     sh_real *restrict F, sh_real *restrict dF);

/* Index i of the power 1 of phi. */
int sh_torque_basis_linear(int symmetric);

#endif
