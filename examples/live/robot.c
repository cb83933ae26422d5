/* Simulates a link of 1.2 kg.m2 on a spring of 600 N.m/rad. The link moves as a sum of two sines. */
#include "robot.h"

#include <math.h>

const double robot_gear = 100.0, robot_B = 1e-4, robot_D_theta = 5e-4;

static const double k = 600.0, M = 1.2;
static const double amplitude[] = {0.5, 0.1}, frequency[] = {3.0, 9.7}; /* [rad], [rad/s] */

robot_sample robot_read(double t)
{
    double q = 0.0, theta = 0.0, theta_dot = 0.0, theta_ddot = 0.0, torque = 0.0;
    for (int i = 0; i < 2; i++) {
        const double w = frequency[i], f = M * w * w * amplitude[i];
        const double motor = amplitude[i] - f / k; /* from M q'' = -k (q - theta) */
        q += amplitude[i] * sin(w * t);
        torque += f * sin(w * t);
        theta += motor * sin(w * t);
        theta_dot += motor * w * cos(w * t);
        theta_ddot -= motor * w * w * sin(w * t);
    }
    return (robot_sample){
        .theta = theta,
        .q = q,
        .tau =
            robot_gear * (robot_B * theta_ddot + robot_D_theta * theta_dot) - torque / robot_gear,
    };
}
