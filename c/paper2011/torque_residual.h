/* Residual for the flexibility torque of one motor, (6)-(8).
 *
 * r_e is the flexibility torque divided by the gear ratio, behind a first-order low pass of
 * bandwidth K_I, (7). The residual r_e needs no torque sensor and no acceleration.
 */
#ifndef SH_TORQUE_RESIDUAL_H
#define SH_TORQUE_RESIDUAL_H

#include "sigmahat.h"

/* Starts the residual at a sample: r_e = 0 and I_tau = 0. */
void sh_torque_residual_start(sh_torque_residual *residual, sh_real tau);

/* Advances the residual by one sample, (8), and returns the estimate gamma r_e of the flexibility torque [N.m].
 *
 * dtheta      change of the motor's position since the last sample, after the gear [rad]
 * dtheta_dot  change of its velocity [rad/s]
 * tau         motor torque on the motor axis [N.m]
 * K_I         bandwidth [1/s], > 0, K_I T < 2
 * T           sample period [s], > 0
 *
 * (8) is computed in differences, r(k) - r(k-1). With differences, I_tau and theta stay in the range of the numbers in
 * runs of any length.
 */
sh_real sh_torque_residual_step(sh_torque_residual *residual, const sh_motor_parameters *motor,
                                sh_real dtheta, sh_real dtheta_dot, sh_real tau, sh_real K_I,
                                sh_real T);

#endif
