/* Stiffness estimator: one tick from measured positions and torque to the
 * stiffness of the transmission, the paper's Fig. 1.
 *
 * The caller owns every struct; the library keeps no memory of its own, does no
 * input or output and may run any number of estimators in any number of threads.
 *
 *     sh_parameters p;
 *     sh_estimator estimator;
 *     sh_estimate estimate;
 *     sh_parameters_default(&p);
 *     if (sh_parameters_check(&p, &violation)) ...
 *     sh_estimator_start(&estimator, &p, &estimate);
 *     every p.samplePeriod seconds:
 *         sh_estimator_tick(&estimator, &p, &measurement, &estimate);
 *
 * Names of parameters and signals are those of the FMU (modelDescription/),
 * whose variables live in these structs.
 */
#ifndef SH_STIFFNESS_ESTIMATOR_H
#define SH_STIFFNESS_ESTIMATOR_H

#include "kinematic_kalman.h"
#include "least_squares.h"
#include "matched_regression.h"
#include "scaled_basis.h"
#include "torque_basis.h"
#include "torque_residual.h"
#include "real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the stiffness is estimated. */
enum {
    SH_METHOD_PAPER2011 = 1,     /* Kalman filter, residual and (25)-(27), as in the paper */
    SH_METHOD_MATCHED_FILTER = 2 /* matched_regression.h */
};

/* What feeds the regression, section VI.B. */
enum {
    SH_MODALITY_RESIDUAL = 1, /* gamma r_e of (8) */
    SH_MODALITY_SENSOR = 2,   /* a torque sensor */
    SH_MODALITY_MODEL = 3     /* the nominal torque (28) at the measured positions */
};

/* Which deformation enters the regression. */
enum {
    SH_DEFORMATION_RAW = 1,     /* q - theta as measured */
    SH_DEFORMATION_FILTERED = 2 /* both positions through the filter */
};

/* Parameters. Those marked "fixed" are read by sh_estimator_start alone or must
 * not change after it; every other may change between ticks and takes effect at
 * the next one.
 */
typedef struct {
    sh_real samplePeriod; /* T [s], > 0, fixed */
    int method;           /* SH_METHOD_*, fixed */
    int modality;         /* SH_MODALITY_* */
    int deformation;      /* SH_DEFORMATION_*, fixed */
    sh_motor_parameters motor;
    struct {
        sh_real K_I; /* bandwidth of the residual [1/s], > 0, K_I T < 2 if it is used */
    } residual;
    sh_filter_parameters filter; /* kind, weighting and P_0 fixed */
    struct {
        sh_real theta, q; /* resolution [counts/turn], >= 0; 0: no quantisation; q acts with
                             SH_DEFORMATION_FILTERED alone; fixed */
        sh_real theta_c;  /* not used: theta_c is not filtered */
    } encoder;
    struct {
        sh_real offset, scale; /* set-point = offset + scale theta_c [1, 1/rad], fixed */
    } setPoint;
    struct {
        int kind;                          /* SH_RLS_*, fixed */
        int symmetric;                     /* 1: torque odd in phi, (16); 0: any; fixed */
        int n, m;                          /* 1..SH_MAX_N, 1..SH_MAX_M, fixed */
        sh_real P_0;                       /* initial covariance, > 0, fixed */
        sh_real c;                         /* (27), > 0, fixed */
        sh_real a;                         /* constant stability factor, (0, 1], fixed */
        sh_real eta_0[SH_MAX_N][SH_MAX_M]; /* initial estimate, fixed */
    } rls;
    struct {
        sh_real k_s; /* stiffness of the springs, (28) [N/m], >= 0 */
        sh_real r_0; /* lever arm at theta_c = 0, (30) [m] */
        sh_real b;   /* lead of the ball screw, (30) [m/rad] */
    } model;         /* for SH_MODALITY_MODEL */
    struct {
        sh_real tau;   /* std deviation of the noise of tau [N.m], 1e-12..1e12 */
        sh_real tau_e; /* and of tau_e_sensor, also how far the model is trusted [N.m],
                          1e-12..1e12 */
    } noise;
    sh_real confidence; /* sigma_std / |sigma| below which the estimate is confident [1], > 0 */
    /* All below for SH_METHOD_MATCHED_FILTER. */
    struct {
        sh_real bandwidth; /* w of the filter [rad/s], > 0, 1e-4 <= w T < 2 if it is used, fixed */
        sh_real slow;      /* |theta'| below which the sign of friction is unknown [rad/s], > 0 */
        sh_real drift;     /* share of its prior variance by which the torque curve drifts in a
                              second [1/s], 0..1e12; 0: it does not change */
    } matched;
    sh_range_parameters range; /* fixed */
    struct {                   /* 0..1e12, fixed */
        sh_real tau_e;         /* std deviation of each coefficient of the torque, for phi and
                                  set-point in units of their range [N.m] */
        sh_real nominal;       /* of the curve rls.eta_0 as a whole, relative [1] */
        sh_real D_theta;       /* of motor.D_theta, relative [1]; 0: exact */
        sh_real B;             /* of motor.B, relative [1]; 0: exact */
        sh_real tau_coulomb;   /* of the Coulomb friction of the motor, on its axis [N.m];
                                  0: there is none */
    } prior;
} sh_parameters;

/* Largest measurement that is taken for one [rad, N.m]. */
#define SH_LARGEST_MEASUREMENT ((sh_real)1e12)

/* One sample of the measurements. */
typedef struct {
    sh_real theta, q, theta_c; /* positions: principal motor after its gear, link,
                                  secondary motor [rad] */
    sh_real tau;               /* torque of the principal motor, on its axis [N.m] */
    sh_real tau_e_sensor;      /* flexibility torque from a sensor, SH_MODALITY_SENSOR [N.m] */
} sh_measurement;

/* What a tick gives. */
typedef struct {
    sh_real sigma;                   /* stiffness, (23) [N.m/rad] */
    sh_real tau_e;                   /* flexibility torque of the fitted model, (21) [N.m] */
    sh_real tau_e_residual;          /* gamma r_e, (8) [N.m] */
    sh_real theta_dot;               /* motor velocity used by the residual [rad/s] */
    sh_real phi;                     /* deformation [rad] */
    sh_real setPoint;                /* set-point [1] */
    sh_real a, rho, epsilon;         /* (27) [1], (14) [1], (14) [N.m] */
    sh_real eta[SH_MAX_N][SH_MAX_M]; /* eta[i][j]: coefficient of setPoint^j phi^(2i+1), (21),
                                        or of setPoint^j phi^i if not symmetric */
    sh_real sigma_std;               /* std deviation of sigma, as far as the method knows
                                        [N.m/rad] */
    sh_real D_theta_hat, B_hat;      /* motor data as corrected [N.m.s/rad, kg.m2] */
    sh_real tau_coulomb_hat;         /* Coulomb friction found, on the motor axis [N.m] */
    int confident;                   /* sigma_std is below confidence |sigma| */
    int valid;                       /* 0 while the last tick was skipped, see sh_estimator_tick */
} sh_estimate;

/* State between ticks. Holds no pointer: copy it by assignment. */
typedef struct {
    sh_kinematic_kalman theta;
    sh_kinematic_kalman q;
    sh_torque_residual residual;
    sh_least_squares rls;
    sh_matched_regression matched;
    int modality;                /* of the last good sample */
    int started;                 /* a good sample has been seen */
    sh_real skipped;             /* ticks skipped since the last good sample */
    sh_real settling;            /* time until r_e has forgotten what was before a gap [s] */
    sh_real units[SH_MAX_BASIS]; /* factors from the coefficients in the unit of the method to
                                    those of the estimate */
    struct {
        sh_real F[SH_MAX_PARAMETERS], dF[SH_MAX_PARAMETERS]; /* zero beyond the basis */
        sh_real eta[SH_MAX_PARAMETERS];
    } work; /* means nothing between ticks; here to spare the stack */
} sh_estimator;

/* A parameter outside its range. */
typedef struct {
    const char *name;  /* as in the FMU, "residual.K_I" */
    sh_real value;     /* what came */
    const char *range; /* what is allowed, "K_I samplePeriod < 2" */
} sh_violation;

/* Sets the parameters of the AwAS, section VI.A, and of the FMU's start values. */
void sh_parameters_default(sh_parameters *p);

/* Returns 0 if every parameter is in its range; else 1, and says in violation
 * which is the first that is not. Its strings live as long as the program.
 */
int sh_parameters_check(const sh_parameters *p, sh_violation *violation);

/* Starts the estimator from parameters that pass sh_parameters_check, and sets
 * the estimate of the initial state: eta_0 at phi = 0 and theta_c = 0.
 */
void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate);

/* Runs one tick. estimate comes in as the last tick, or sh_estimator_start, left it.
 *
 * Returns 1 and the new estimate. If any measurement is not finite or beyond
 * SH_LARGEST_MEASUREMENT, or the regressor overflows, the tick is skipped: returns 0, sets
 * estimate->valid to 0 and leaves all else as it was. The next good sample ends the gap:
 *
 * SH_METHOD_PAPER2011 filters over the time that has passed. The residual
 * bridges a gap shorter than 2 / K_I; after a longer one it goes on from its
 * last value, and with SH_MODALITY_RESIDUAL nothing is learned, a = 0, until it
 * has forgotten that value, ten time constants 1 / K_I later.
 *
 * SH_METHOD_MATCHED_FILTER begins its filters anew and learns nothing for
 * 12 / matched.bandwidth; the same after a change of the modality.
 */
int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate);

#ifdef __cplusplus
}
#endif
#endif
