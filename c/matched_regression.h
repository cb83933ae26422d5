/* Regression of the method MatchedFilter: torque and motor data at once, from
 * signals that all passed the same filter.
 *
 * The motor (3) with Coulomb friction, and its data B, D_theta wrong by the
 * relative errors b and d,
 *
 *     (1+b) B gamma theta'' + (1+d) D_theta gamma theta' + tau_C sign(theta')
 *         - tau_e / gamma = tau ,
 *
 * becomes, with both sides through H(s) (state_variable_filter.h, index f) and
 * tau_e = F' eta of (21), the regression
 *
 *     y = gamma (B gamma theta''_f + D_theta gamma theta'_f - tau_f)
 *       = F_f' eta - gamma^2 D_theta theta'_f d - gamma^2 B theta''_f b
 *         - |gamma| sign(theta')_f tau_C .
 */
#ifndef SH_MATCHED_REGRESSION_H
#define SH_MATCHED_REGRESSION_H

#include "least_squares.h"
#include "motion_sign.h"
#include "rounding_bias.h"
#include "state_variable_filter.h"
#include "torque_residual.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Place of the motor data behind the coefficients of the torque. */
enum { SH_MOTOR_D_THETA = 0, SH_MOTOR_B = 1, SH_MOTOR_COULOMB = 2 };

/* What one run of the regression is told. Values may change between samples. */
typedef struct {
    sh_real T;         /* sample period [s], > 0 */
    sh_real bandwidth; /* w of the filter [rad/s], 1e-4 <= w T < 2, fixed */
    int measured;      /* 1: the torque is measured; 0: it is what moves the motor */
    sh_real noise;     /* std deviation of the noise of that torque [N.m], > 0 */
    sh_motor_parameters motor;
    sh_real count;   /* resolution of theta [rad], >= 0 */
    sh_real count_q; /* resolution of q [rad], >= 0 */
    sh_real slow;    /* |theta'| below which the sign of friction is not known [rad/s], > 0 */
    sh_real drift;   /* share of its prior variance by which the torque curve drifts in a second
                        [1/s], >= 0 */
    sh_real torque;  /* prior: std deviation of each coefficient of the torque [N.m], >= 0 */
    sh_real nominal; /* prior: relative std deviation of the curve eta_0 as a whole, >= 0 */
    sh_real motor_prior[SH_MAX_MOTOR]; /* prior: std deviations of d [1], b [1], tau_C [N.m],
                                          >= 0; 0 switches the column off */
} sh_matched_settings;

/* State between samples. */
typedef struct {
    int basis;                              /* number of coefficients of the torque */
    sh_real eta_0[SH_MAX_BASIS];            /* prior mean */
    sh_state_variable_filter theta, torque; /* measured signals */
    sh_state_variable_filter friction;      /* sign of the velocity */
    sh_state_variable_filter unknown;       /* share of it that is not known */
    sh_state_variable_filter column[SH_MAX_BASIS];
    sh_motion_sign motion;
    sh_rounding_bias bias; /* of b */
    sh_real phi;           /* deformation at the last sample [rad] */
    sh_real resting;       /* samples for which it has been the same */
    sh_real unsure;        /* samples for which the sign of the velocity has not been known */
    sh_real settling;      /* time until the filters have forgotten what came before [s] */
    sh_real starting;      /* time for which samples may show that the motor was not at rest [s] */
    sh_filter_design design;
    sh_real rounding; /* variance of theta'' filtered for a rounding of one [1/s4] */
    int begun;        /* 0: the filters begin with the next sample */
    struct {
        sh_real F[SH_MAX_PARAMETERS], direction[SH_MAX_PARAMETERS];
    } work; /* means nothing between samples; here to spare the stack */
} sh_matched_regression;

/* Starts regression and recursion.
 *
 * basis  number of coefficients of the torque, 1..SH_MAX_BASIS
 * eta_0  [size: basis] prior mean of the coefficients [N.m]
 */
void sh_matched_start(sh_matched_regression *matched, sh_least_squares *rls,
                      const sh_matched_settings *settings, int basis, const sh_real *eta_0);

/* Lets the filters begin anew with the next sample and learns nothing until they have
 * settled. For use after samples were lost; what was learned stays.
 */
void sh_matched_resume(sh_matched_regression *matched, const sh_matched_settings *settings);

/* Takes one sample.
 *
 * theta   position of the motor [rad]
 * torque  motor torque, or measured flexibility torque [N.m]
 * phi     measured deformation [rad]
 * sigma   stiffness as far as known, by which the rounding of phi is torque [N.m/rad]
 * F       [size: basis] regressor of the torque
 * y       out: filtered flexibility torque by the nominal motor data [N.m]
 *
 * Returns 1. Returns 0, with the recursion as it was, if the numbers are too large.
 */
int sh_matched_step(sh_matched_regression *matched, sh_least_squares *rls,
                    const sh_matched_settings *settings, sh_real theta, sh_real torque, sh_real phi,
                    sh_real sigma, const sh_real *F, sh_real *y, sh_innovation *innovation);

/* What is believed of the parameters, see sh_rounding_bias_belief.
 *
 * eta   [size: rls->size] out: estimate
 * dF    [size: rls->size] combination of parameters
 *
 * Returns the variance of dF' eta.
 */
sh_real sh_matched_belief(const sh_matched_regression *matched, sh_least_squares *rls,
                          const sh_matched_settings *settings, const sh_real *dF, sh_real *eta);

#ifdef __cplusplus
}
#endif
#endif
