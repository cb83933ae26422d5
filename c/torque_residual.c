#include "torque_residual.h"

void sh_torque_residual_start(sh_torque_residual *residual, double tau)
{
    residual->r_e = 0.0;
    sh_torque_residual_resume(residual, tau);
}

void sh_torque_residual_resume(sh_torque_residual *residual, double tau)
{
    residual->tau = tau;
}

double sh_torque_residual_step(sh_torque_residual *residual, const sh_motor_parameters *motor,
                               double dtheta, double dtheta_dot, double tau, double K_I, double T)
{
    /* (8): r(k) - r(k-1) = K_I (B gamma dtheta_dot + D_theta gamma dtheta - dI_tau) */
    const double impulse = (tau + residual->tau) / 2.0 * T;
    const double change =
        K_I * (motor->gamma * (motor->B * dtheta_dot + motor->D_theta * dtheta) - impulse);

    residual->r_e =
        (2.0 - T * K_I) / (2.0 + T * K_I) * residual->r_e + 2.0 * change / (2.0 + T * K_I);
    sh_torque_residual_resume(residual, tau);
    return motor->gamma * residual->r_e;
}
