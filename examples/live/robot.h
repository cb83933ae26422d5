/* The simulated joint of this example. For your own joint, replace the simulation by code that reads the sensors. */
#ifndef ROBOT_H
#define ROBOT_H

/* Positions of motor and link after the gear [rad], and torque of the motor before the gear [N.m]. */
typedef struct {
    double theta, q, tau;
} robot_sample;

extern const double robot_gear, robot_B, robot_D_theta; /* [1], [kg.m2], [N.m.s/rad] */

/* Returns the measurements at time t [s]. */
robot_sample robot_read(double t);

#endif
