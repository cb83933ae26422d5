/* Kinematic Kalman filter for quantised positions, (9)-(11).
 *
 * Estimates position and velocity of one axis from its encoder alone. Equation
 * numbers, here and in all of c/, are those of Flacco, De Luca, Sardellitti and
 * Tsagarakis, "Robust Estimation of Variable Stiffness in Flexible Joints",
 * IROS 2011.
 */
#ifndef SH_KINEMATIC_KALMAN_H
#define SH_KINEMATIC_KALMAN_H

#include "real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the velocity is obtained. */
enum {
    SH_FILTER_MODIFIED_KALMAN = 1,  /* R follows the velocity, (11) */
    SH_FILTER_KALMAN = 2,           /* R constant */
    SH_FILTER_FINITE_DIFFERENCE = 3 /* no filter: (x(k) - x(k-1)) / T */
};

/* How (11) compares the velocity with the encoder resolution w_s. */
enum {
    SH_WEIGHTING_NORMALIZED = 1, /* |x'| / w_s - 1: crosses 0 at one count per sample */
    SH_WEIGHTING_AS_PRINTED = 2  /* |x'| w_s - 1: the formula as printed */
};

/* Settings of the filter. */
typedef struct {
    int kind;      /* SH_FILTER_* */
    int weighting; /* SH_WEIGHTING_* */
    sh_real V_a;   /* (9) variance of the acceleration [rad2/s4], >= 0 */
    sh_real V_max; /* (11) measurement variance at rest [rad2], > 0, >= V_min */
    sh_real V_min; /* (11) measurement variance in fast motion [rad2], > 0 */
    sh_real alpha; /* (11) steepness between the two [1], >= 0 */
    sh_real R;     /* (10) constant measurement variance, SH_FILTER_KALMAN [rad2], > 0 */
    sh_real P_0;   /* initial covariance, both diagonal entries [rad2, rad2/s2], > 0 */
} sh_filter_parameters;

/* State of the filter of one axis. */
typedef struct {
    sh_real z;             /* measured position [rad] */
    sh_real lag;           /* estimated position less the measured [rad]: small, so that the
                              filter keeps its digits however far the axis has turned */
    sh_real x_dot;         /* velocity [rad/s] */
    sh_real dx, dx_dot;    /* how position and velocity changed with the last sample */
    sh_real P11, P12, P22; /* covariance of (x, x_dot) */
} sh_kinematic_kalman;

/* Measurement variance R at a velocity, (11) [rad2].
 *
 * filter  settings, weighting as chosen there
 * x_dot   velocity [rad/s]
 * w_s     velocity of one count per sample, (2 pi / counts) / T [rad/s]; 0 for
 *         an encoder without quantisation, whose R is V_min whatever the weighting
 */
sh_real sh_measurement_variance(const sh_filter_parameters *filter, sh_real x_dot, sh_real w_s);

/* Starts the filter at a measured position z [rad]: zero velocity, covariance P_0 I. */
void sh_kinematic_kalman_start(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                               sh_real z);

/* Advances the filter by one sample: (9), then R from the predicted velocity, then (10).
 *
 * z    measured position [rad], finite
 * dt   time since the last sample [s], > 0
 * w_s  velocity of one count per sample period [rad/s], >= 0
 */
void sh_kinematic_kalman_step(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                              sh_real z, sh_real dt, sh_real w_s);

#ifdef __cplusplus
}
#endif
#endif
