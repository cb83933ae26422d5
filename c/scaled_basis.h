/* The basis of torque_basis.h in units that suit a prior.
 *
 * Deformation and set-point are taken in units of their ranges, and a power e of
 * the deformation is divided by e:
 *
 *     (l / l_range)^j (phi / phi_range)^e / e .
 *
 * Coefficients are torques [N.m] then, and where phi and l are as large as their
 * ranges, coefficients of equal size contribute equally to the stiffness.
 */
#ifndef SH_SCALED_BASIS_H
#define SH_SCALED_BASIS_H

#include "torque_basis.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    sh_real phi;      /* largest deformation to be expected [rad], 1e-6..1e6 */
    sh_real setPoint; /* largest set-point to be expected [1], 1e-12..1e12 */
} sh_range_parameters;

/* Regressor F and its derivative dF by phi [1/rad]; arguments as for sh_torque_basis. */
void sh_scaled_basis(const sh_range_parameters *range, int symmetric, int n, int m,
                     sh_real set_point, sh_real phi, sh_real *F, sh_real *dF);

/* Factors from the coefficients of setPoint^j phi^e to those of the scaled basis, in F's order. */
void sh_scaled_basis_units(const sh_range_parameters *range, int symmetric, int n, int m,
                           sh_real *units);

#ifdef __cplusplus
}
#endif
#endif
