/* Separable polynomial basis of the flexibility torque, (18)-(23). */
#ifndef SH_TORQUE_BASIS_H
#define SH_TORQUE_BASIS_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SH_MAX_N = 8,                        /* largest order in the deformation */
    SH_MAX_M = 5,                        /* largest order in the set-point */
    SH_MAX_PARAMETERS = SH_MAX_N * SH_MAX_M
};

/* Regressor F of (22) and its derivative by the deformation, (23).
 *
 * n, m       orders, 1..SH_MAX_N and 1..SH_MAX_M
 * set_point  l: what stands for theta_c in (19), the AwAS lever arm in mm
 * phi        deformation [rad]
 * F          [size: n m] F[j n + i] = l^j phi^(2i+1)
 * dF         [size: n m] dF[j n + i] = (2i+1) l^j phi^(2i)
 *
 * The torque (21) is F' eta, the stiffness (23) is dF' eta, with eta in the
 * same order.
 */
void sh_torque_basis(int n, int m, double set_point, double phi, double *F, double *dF);

#ifdef __cplusplus
}
#endif
#endif
