/* Kinematic Kalman filter for quantised positions, (9)-(11).
 *
 * The filter estimates position and velocity of one axis from its encoder alone.
 */
#ifndef SH_KINEMATIC_KALMAN_H
#define SH_KINEMATIC_KALMAN_H

#include "sigmahat.h"

/* Starts the filter at a measured position z [rad]: zero velocity, covariance P_0 I. */
void sh_kinematic_kalman_start(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                               sh_real z);

/* Advances the filter by one sample: (9), then R from the predicted velocity, then (10).
 *
 * z    measured position [rad], finite
 * dt   time since the last sample [s], > 0
 * w_s  velocity of one count per sample period, (2 pi / counts) / T [rad/s]; 0 for an encoder
 *      without quantisation
 */
void sh_kinematic_kalman_step(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                              sh_real z, sh_real dt, sh_real w_s);

#endif
