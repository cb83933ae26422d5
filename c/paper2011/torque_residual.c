#include "torque_residual.h"

void sh_torque_residual_start(sh_torque_residual *residual, sh_real tau)
{
    residual->r_e = 0;
    residual->tau = tau;
}

sh_real sh_torque_residual_step(sh_torque_residual *residual, const sh_motor_parameters *motor,
                                sh_real dtheta, sh_real dtheta_dot, sh_real tau, sh_real K_I,
                                sh_real T)
{
    /* (8): r(k) - r(k-1) = K_I (B gamma dtheta_dot + D_theta gamma dtheta - dI_tau) */
    const sh_real impulse = (tau + residual->tau) / 2 * T;
    const sh_real change =
        K_I * (motor->gamma * (motor->B * dtheta_dot + motor->D_theta * dtheta) - impulse);

    residual->r_e = (2 - T * K_I) / (2 + T * K_I) * residual->r_e + 2 * change / (2 + T * K_I);
    residual->tau = tau;
    return motor->gamma * residual->r_e;
}
