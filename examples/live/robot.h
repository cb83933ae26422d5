/* The joint of this example. Replace it by yours: read the encoders and the torque of the motor. */
#ifndef ROBOT_H
#define ROBOT_H

/* Positions of motor and link behind the gear [rad], torque of the motor before it [N.m]. */
typedef struct {
    double theta, q, tau;
} robot_sample;

extern const double robot_gear, robot_B, robot_D_theta; /* [1], [kg.m2], [N.m.s/rad] */

/* The sample at a time [s]. */
robot_sample robot_read(double t);

#endif
