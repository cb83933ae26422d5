/* The basis of torque_basis.h in units that suit a prior.
 *
 * Deformation and set-point are divided by their ranges, and a power e of the deformation is
 * divided by e:
 *
 *     (l / l_range)^j (phi / phi_range)^e / e .
 *
 * The coefficients are then torques [N.m]. At the ends of the ranges, coefficients of equal size
 * contribute equally to the stiffness.
 */
#ifndef SH_SCALED_BASIS_H
#define SH_SCALED_BASIS_H

#include "sigmahat.h"

/* Regressor F and its derivative dF by phi [1/rad]; arguments as for sh_torque_basis. */
void sh_scaled_basis(const sh_range_parameters *range, int symmetric, int n, int m,
                     sh_real set_point, sh_real phi, sh_real *F, sh_real *dF);

/* Power of phi that belongs to number i. */
int sh_scaled_basis_power(int symmetric, int i);

/* What a coefficient of the scaled basis is multiplied by to get that of setPoint^j phi^e, where e
 * is the power that belongs to number i.
 */
sh_real sh_scaled_basis_unit(const sh_range_parameters *range, int symmetric, int i, int j);

#endif
