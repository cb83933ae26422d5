/* sigmahat: the stiffness of a flexible robot joint, estimated on line from positions and torque.
 *
 * Equation numbers in c/ are from the paper "Robust Estimation of Variable Stiffness in Flexible Joints" by Flacco, De
 * Luca, Sardellitti and Tsagarakis, IROS 2011. One tick of the estimator is Fig. 1 of the paper.
 *
 *     sh_parameters p;
 *     sh_violation violation;
 *     sh_estimator estimator;
 *     sh_estimate estimate;
 *     sh_parameters_default_at(&p, 1e-3);
 *     p.motor.gamma = ...
 *     if (sh_parameters_check(&p, &violation)) ...
 *     sh_estimator_start(&estimator, &p, &estimate);
 *     every p.samplePeriod seconds:
 *         sh_estimator_tick(&estimator, &p, &measurement, &estimate);
 *
 * The caller provides the memory of every struct. The library allocates no memory, has no global variables, and does no
 * input or output. Any number of estimators can run in any number of threads. A function that returns an int returns 0
 * if there is no error.
 *
 * Parameters and signals have the same names as the variables of the FMU (modelDescription/).
 */
#ifndef SIGMAHAT_H
#define SIGMAHAT_H

#ifdef __cplusplus
extern "C" {
#endif

/* The floating-point type of the whole library is double. For float, compile every file of the
 * library, and every file that includes this header, with -DSH_REAL=float.
 */
#ifndef SH_REAL
#define SH_REAL double
#endif
typedef SH_REAL sh_real;

/* The methods of estimation, one line each: constant, number and name in the FMU, block of c/.
 * This is the only list of the methods; method.h describes how to add one.
 *
 * Paper2011      the paper: Kalman filter (9)-(11), residual (6)-(8), least squares (25)-(27)
 * FilteredRegression  one regression for the torque and the errors of the motor data, from signals
 *                that all passed the same filter: c/filtered_regression/columns.c
 */
#define SH_METHODS(METHOD)                                                                         \
    METHOD(SH_METHOD_PAPER2011, 1, "Paper2011", sh_paper2011)                                      \
    METHOD(SH_METHOD_FILTERED_REGRESSION, 2, "FilteredRegression", sh_filtered_regression)         \
    /* the next method here */
#define SH_METHOD_CONSTANT(constant, number, name, block) constant = number,
enum { SH_METHODS(SH_METHOD_CONSTANT) };

/* Source of the torque for the regression, section VI.B. */
enum {
    SH_MODALITY_RESIDUAL = 1, /* gamma r_e of (8) */
    SH_MODALITY_SENSOR = 2,   /* a torque sensor */
    SH_MODALITY_MODEL = 3     /* the nominal torque (28) at the measured positions */
};

/* Which deformation enters the regression. */
enum {
    SH_DEFORMATION_RAW = 1,     /* q - theta as measured */
    SH_DEFORMATION_FILTERED = 2 /* both positions through the Kalman filter */
};

/* How the velocity is obtained. */
enum {
    SH_FILTER_MODIFIED_KALMAN = 1,  /* R depends on the velocity, (11) */
    SH_FILTER_KALMAN = 2,           /* R constant */
    SH_FILTER_FINITE_DIFFERENCE = 3 /* no filter: (x(k) - x(k-1)) / T */
};

/* How (11) compares the velocity with the encoder resolution w_s. */
enum {
    SH_WEIGHTING_NORMALIZED = 1, /* |x'| / w_s - 1: crosses 0 at one count per sample */
    SH_WEIGHTING_AS_PRINTED = 2  /* |x'| w_s - 1: the formula as printed */
};

/* Kinds of recursive least squares. */
enum {
    SH_RLS_ENHANCED = 1,       /* a(k) of (27) */
    SH_RLS_STANDARD = 2,       /* a = 1, (14) */
    SH_RLS_CONSTANT_FACTOR = 3 /* constant a in (25) */
};

/* Reasons why the estimate is not confident. The library reports the last reason of this list. */
enum {
    SH_DOUBT_NONE = 1,           /* it is confident */
    SH_DOUBT_NO_CLAIM,           /* the method computes no uncertainty that contains all errors */
    SH_DOUBT_NOT_EXCITED,        /* sigma_std is too large, as the motion was too small or short */
    SH_DOUBT_MISFIT,             /* the data contradict the model, and sigma_std is large or new */
    SH_DOUBT_OUT_OF_RANGE,       /* the deformation is beyond what the parameters are made for */
    SH_DOUBT_FRICTION,           /* D_theta_hat is far from its prior, or below 0 */
    SH_DOUBT_INERTIA,            /* B_hat is beyond three std deviations of its prior */
    SH_DOUBT_NEGATIVE_STIFFNESS, /* sigma is below 0 */
    SH_DOUBT_CHANGE, /* stiffness or friction may have changed, the estimate does not follow yet */
    SH_DOUBT_HELD_INPUTS, /* samples were repeated; the library never reports it, as it cannot know.
                             A caller that repeats samples may, as the FMUs do */
    SH_DOUBT_OUTLIER      /* samples that no joint can give are being skipped */
};

/* Largest orders of the polynomials (18) and (19), in the deformation and in the set-point. These orders determine
 * the size of sh_estimator. Compiler options can define smaller orders, as plain numbers. The sizes must be the same
 * for every file of the library, and every file that includes this header.
 */
#ifndef SH_MAX_N
#define SH_MAX_N 8
#endif
#ifndef SH_MAX_M
#define SH_MAX_M 5
#endif
enum { SH_MAX_BASIS = SH_MAX_N * SH_MAX_M };

/* Largest number of columns of the regression: the columns of the basis, and the other columns of columns.c. If priors
 * of 0 remove columns, a smaller number as a compiler option saves memory. With the largest orders, a second knee fits
 * only if two other columns are removed.
 */
#ifndef SH_MAX_COLUMNS
enum { SH_MAX_COLUMNS = SH_MAX_BASIS + 24 };
#endif

/* For the linker, the name of this function contains the sizes above, as the compiler options define them. If a file
 * was compiled with other sizes than the library, the linker finds no function.
 */
#define sh_estimator_start SH_SIZED(sh_estimator_start, SH_REAL, SH_MAX_N, SH_MAX_M, SH_MAX_COLUMNS)
#define SH_SIZED(name, real, n, m, columns) SH_JOINED(name, real, n, m, columns)
#define SH_JOINED(name, real, n, m, columns) name##_##real##_##n##_##m##_##columns

/* Data of the motor, (3). */
typedef struct {
    sh_real B;       /* rotor inertia [kg.m2], >= 1e-15 */
    sh_real D_theta; /* viscous friction [N.m.s/rad], >= 0 */
    sh_real gamma;   /* gear ratio [1], not 0 */
} sh_motor_parameters;

/* Settings of the Kalman filter, (9)-(11). */
typedef struct {
    int kind;      /* SH_FILTER_*, fixed */
    int weighting; /* SH_WEIGHTING_*, fixed */
    sh_real V_a;   /* (9) variance of the acceleration [rad2/s4], >= 0 */
    sh_real V_max; /* (11) measurement variance at rest [rad2], >= V_min */
    sh_real V_min; /* (11) measurement variance in fast motion [rad2], >= 1e-30 */
    sh_real alpha; /* (11) steepness between the two [1], >= 0 */
    sh_real R;     /* (10) constant measurement variance, SH_FILTER_KALMAN [rad2], >= 1e-30 */
    sh_real P_0;   /* initial covariance, both diagonal entries [rad2, rad2/s2], >= 1e-30, fixed */
} sh_filter_parameters;

/* Ranges of the operating point. */
typedef struct {
    sh_real phi;      /* largest deformation to be expected [rad], 1e-6..1e6 */
    sh_real setPoint; /* largest distance of the set-point from its center [1], 1e-12..1e12 */
    sh_real setPoint_center; /* middle of the set-points to be expected [1], -1e12..1e12 */
    /* Deformations over phi at which the slope of the curve changes at once, on both sides [1], 0..1: */
    sh_real knee;   /* 0: not known, and used if the data ask for it */
    sh_real knee_2; /* a second one; 0: there is none */
} sh_range_parameters;

/* Std deviations of quantities that are not known exactly, each 0..1e12. With 0, the quantity is known exactly, or the
 * effect does not exist. The scale K_0 of the stiffness is prior.tau_e / range.phi.
 */
typedef struct {
    sh_real tau_e;         /* of each coefficient of the torque, for phi and set-point in units of
                              their range [N.m] */
    sh_real nominal;       /* of the curve rls.eta_0 as a whole, relative [1] */
    sh_real D_theta;       /* of motor.D_theta, relative [1] */
    sh_real B;             /* of motor.B, relative [1] */
    sh_real tau_coulomb;   /* of the Coulomb friction of the motor, on its axis [N.m] */
    sh_real torque_gain;   /* of the gain of the torque, relative [1]: torque constant, current
                              sensor, efficiency of the gear. No data show it */
    sh_real bias;          /* of a constant torque: bias of the torque, zero of the deformation,
                              uneven friction; share of prior.tau_e [1] */
    sh_real damping;       /* of the damping of the spring over K_0; also of encoders that are read
                              at different times [s] */
    sh_real load_friction; /* of the friction per flexibility torque, and, where tau_coulomb is not
                              0, per motor torque [1] */
    sh_real eccentric;     /* of the once-per-turn error of the link encoder [rad]; 3.5 % of it
                              stand for harmonics of the encoders and of the gear */
    sh_real delay;         /* of the delay of the torque against the positions [s] */
    sh_real reversal;      /* of a delay of the reversals of friction [s] */
    /* Columns that are used if the data ask for them: */
    sh_real power;           /* of more powers of phi and set-point; share of prior.tau_e [1] */
    sh_real gap;             /* of torques lost in a dead zone; share of prior.tau_e [1] */
    sh_real hysteresis;      /* of torques of hysteresis; share of prior.tau_e [1] */
    sh_real eccentric_motor; /* of the once-per-turn error of the motor encoder, behind the gear
                                [rad] */
} sh_prior_parameters;

/* Parameters of an estimator. Parameters marked "fixed" must not change after sh_estimator_start. Every other parameter
 * may change between ticks, and the new value is used from the next tick on. But the filters of FilteredRegression are
 * designed only at the start, from modality, motor.B, motor.gamma and noise.tau.
 */
typedef struct {
    sh_real samplePeriod; /* T [s], >= 1e-9, fixed */
    int method;           /* SH_METHOD_*, fixed */
    int modality;         /* SH_MODALITY_* */
    int deformation;      /* SH_DEFORMATION_*, fixed; for SH_METHOD_PAPER2011 */
    sh_motor_parameters motor;
    struct {
        sh_real K_I; /* bandwidth of the residual [1/s], >= 1e-15; K_I T < 2 with
                        SH_METHOD_PAPER2011 */
    } residual;
    sh_filter_parameters filter;
    struct {
        sh_real theta, q; /* resolution [counts/turn], >= 0, fixed; 0: no quantisation.
                             SH_METHOD_PAPER2011 uses q with SH_DEFORMATION_FILTERED only */
        sh_real theta_c;  /* has no effect, as no method filters theta_c; it is here because
                             the FMUs have it [counts/turn], >= 0 */
    } encoder;
    struct {
        sh_real offset, scale; /* set-point = offset + scale theta_c [1, 1/rad], fixed */
    } setPoint;
    struct {
        int kind;                          /* SH_RLS_*, fixed */
        int symmetric;                     /* 1: torque odd in phi, (16); 0: any; fixed */
        int n, m;                          /* orders, 1..SH_MAX_N, 1..SH_MAX_M, fixed */
        sh_real P_0;                       /* initial covariance, >= 1e-30, fixed */
        sh_real c;                         /* (27), >= 1e-30, fixed */
        sh_real a;                         /* constant stability factor, 1e-15..1, fixed */
        sh_real eta_0[SH_MAX_N][SH_MAX_M]; /* initial estimate, fixed */
    } rls;
    struct {
        sh_real k_s; /* stiffness of the springs, (28) [N/m], >= 0 */
        sh_real r_0; /* lever arm at theta_c = 0, (30) [m] */
        sh_real b;   /* lead of the ball screw, (30) [m/rad] */
    } model;         /* for SH_MODALITY_MODEL */
    struct {
        sh_real tau;   /* std deviation of the noise of tau [N.m], 1e-12..1e12 */
        sh_real tau_e; /* std deviation of the noise of tau_e_sensor, and of the error of the
                          model of SH_MODALITY_MODEL [N.m], 1e-12..1e12 */
    } noise;
    struct {
        sh_real relative_std; /* sigma_std / |sigma| below which the estimate can be confident [1],
                                 >= 1e-15 */
    } limit;
    /* All below for SH_METHOD_FILTERED_REGRESSION. */
    struct {
        int held; /* 1: a drive holds each tau until the next sample; 0: tau is linear between
                     samples */
    } torque;
    struct {
        sh_real bandwidth; /* w of the filter [rad/s], fixed; 1e-4 <= w T < 2 with this
                              method. A smaller one is used if the rounding of theta needs it:
                              c/filtered_regression/signals.c */
        sh_real slow;      /* |theta'| below which the sign of friction is unknown [rad/s],
                              >= 1e-15 */
        sh_real drift;     /* share of its prior variance by which the torque curve drifts in a
                              second [1/s], 0..1e12; 0: it does not change */
        sh_real memory;    /* time constant with which data are forgotten while they contradict
                              the model [s], 0..1e12; 0: neither does a misfit make the
                              estimate less certain, nor is a change detected */
        int decimation;    /* samples of a row of the regression, 0..64, fixed; 0: as many as the
                              bandwidth allows */
    } regression;
    sh_range_parameters range; /* fixed */
    sh_prior_parameters prior; /* fixed */
} sh_parameters;

/* Largest magnitude of a measurement [rad, N.m]. */
#define SH_LARGEST_MEASUREMENT ((sh_real)1e12)

/* One sample of the measurements. */
typedef struct {
    sh_real theta, q, theta_c; /* positions: principal motor after its gear, link,
                                  secondary motor [rad] */
    sh_real tau;               /* torque of the principal motor, on its axis [N.m] */
    sh_real tau_e_sensor;      /* flexibility torque from a sensor, SH_MODALITY_SENSOR [N.m] */
} sh_measurement;

/* The outputs of a tick. An output that would overflow is limited to 1e300 in magnitude, or 1e38 in single
 * precision; only sigma_std and tau_e_std are infinite in this case.
 */
typedef struct {
    sh_real sigma;                   /* stiffness, (23): slope of the torque where the spring is
                                        engaged, without hysteresis [N.m/rad] */
    sh_real tau_e;                   /* flexibility torque of the fitted model, (21) [N.m] */
    sh_real tau_e_residual;          /* flexibility torque from the motor data: gamma r_e, (8), or
                                        y of columns.c [N.m] */
    sh_real theta_dot;               /* motor velocity used by the residual [rad/s] */
    sh_real phi;                     /* deformation used by the regression [rad] */
    sh_real setPoint;                /* set-point [1] */
    sh_real a, rho, epsilon;         /* (27) [1], (14) [1], (14) [N.m] */
    sh_real eta[SH_MAX_N][SH_MAX_M]; /* eta[i][j]: coefficient of setPoint^j phi^(2i+1), (21),
                                        or of setPoint^j phi^i if not symmetric */
    sh_real sigma_std;               /* std deviation of sigma by the model of the method
                                        [N.m/rad]; infinite if its square overflows */
    sh_real tau_e_std;               /* the same of tau_e [N.m] */
    sh_real D_theta_hat, B_hat;      /* corrected motor data [N.m.s/rad, kg.m2] */
    sh_real tau_coulomb_hat;         /* Coulomb friction obtained, on the motor axis [N.m] */
    sh_real misfit;                  /* square root of how much larger the slow part of the
                                        prediction error is than its noise; 1 where the model
                                        holds [1] */
    sh_real bias_hat;                /* constant torque, see prior.bias [N.m] */
    sh_real damping_hat;             /* damping of the spring [N.m.s/rad] */
    sh_real load_friction_hat;       /* friction per torque, of spring and motor [1] */
    sh_real eccentric_hat;           /* amplitude of the once-per-turn error of the link encoder
                                        [rad] */
    sh_real delay_hat;               /* delay of the torque [s] */
    sh_real hysteresis_hat;          /* half the height of the hysteresis loop [N.m] */
    sh_real sigma_per_gain;          /* relative change of sigma with a relative change of the
                                        gain of the torque [1] */
    sh_real change_age; /* time since a change of the stiffness was last detected [s]; -1: none */
    int doubt;          /* SH_DOUBT_*: why the estimate is not confident */
    int confident;      /* 1: doubt is SH_DOUBT_NONE */
    int valid;          /* 0: the last tick was skipped, see sh_estimator_tick */
} sh_estimate;

/* Torque and stiffness of the spring at a deformation and a set-point. */
typedef struct {
    sh_real tau_e;     /* flexibility torque, (21) [N.m] */
    sh_real tau_e_std; /* its std deviation by the model of the method; may be infinite [N.m] */
    sh_real sigma;     /* stiffness, (23) [N.m/rad] */
    sh_real sigma_std; /* its std deviation; may be infinite [N.m/rad] */
    sh_real sigma_per_gain; /* relative change of sigma with a relative change of the gain of the
                               torque [1] */
} sh_point;

/* A parameter outside its range. */
typedef struct {
    const char *name;  /* as in the FMU: "residual.K_I" */
    sh_real value;     /* its value */
    const char *range; /* the allowed values: ">= 1e-15 and < 2 / samplePeriod" */
} sh_violation;

/* State of an estimator between ticks. The struct contains no pointer, so an assignment copies the struct. */
typedef struct sh_estimator sh_estimator;

/* Sets the parameters of the AwAS, section VI.A, which are the start values of the FMU. The orders are
 * at most SH_MAX_N and SH_MAX_M.
 */
void sh_parameters_default(sh_parameters *p);

/* The same for samples that are samplePeriod [s] apart. Where 1 / samplePeriod is lower than the start value of
 * residual.K_I or regression.bandwidth, the rate starts at 1 / samplePeriod: filters are not faster than the samples.
 */
void sh_parameters_default_at(sh_parameters *p, sh_real samplePeriod);

/* Returns 0 if every parameter is in its range. Otherwise, returns 1 and describes the first parameter outside its
 * range in violation. The strings in violation are constants of the library.
 */
int sh_parameters_check(const sh_parameters *p, sh_violation *violation);

/* Returns the largest |phi| [rad] for which the parameters are suitable. At a larger deformation, the stiffness may be
 * very wrong. The result is at least range.phi, and infinite for a method without such a limit.
 *
 * p  parameters that pass sh_parameters_check
 */
sh_real sh_parameters_largest_deformation(const sh_parameters *p);

/* Starts the estimator, and sets the estimate of the initial state: eta_0 at phi = 0 and theta_c = 0.
 *
 * p  parameters that pass sh_parameters_check
 */
void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate);

/* Runs one tick.
 *
 * p         parameters that pass sh_parameters_check
 * z         the measurements of this tick
 * estimate  in: as the last tick, or sh_estimator_start, left it; out: the new estimate
 *
 * Returns 0, or 1 if the tick is skipped: a measurement is not finite or beyond SH_LARGEST_MEASUREMENT, or the numbers
 * overflow. A skipped tick is counted and sets estimate->valid to 0. The other members of the estimate do not change.
 * The state changes only if the numbers overflow. SH_METHOD_FILTERED_REGRESSION also skips a sample that no joint can
 * give after the samples before it, for at most 0.12 s: estimate->doubt is then SH_DOUBT_OUTLIER, and estimate->confident
 * is 0. After such a gap, the first good sample depends on the method:
 *
 * SH_METHOD_PAPER2011 advances its filters over the whole gap. If the gap is shorter than 2 / K_I, the residual
 * integrates over the gap as over one long sample. After a longer gap, the residual starts from its last value. With
 * SH_MODALITY_RESIDUAL, the regression then does not change (a = 0) for ten time constants 1 / K_I, until the effect of
 * this value has decayed.
 *
 * SH_METHOD_FILTERED_REGRESSION starts its filters again, and does not change its regression for 12 / w. The corner
 * frequency w is at most regression.bandwidth. A change of the modality has the same effect.
 */
int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate);

/* Evaluates the present estimate at any deformation, (21) and (23). The estimator does not change. A tick computes the
 * same numbers for its own phi and setPoint. But with SH_METHOD_FILTERED_REGRESSION, the standard deviations of a tick
 * may belong to the deformation of the last row. The last row is up to regression.decimation samples, or 2.5 / w,
 * older; w is the corner frequency of the filters.
 *
 * p         parameters that pass sh_parameters_check; the fixed ones as they were at the start
 * phi       deformation [rad]
 * setPoint  set-point [1]
 *
 * Returns 0, or 1 if phi or setPoint is not finite, or torque or stiffness overflows: then every
 * number of the point is infinite.
 */
int sh_estimator_evaluate(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                          sh_real setPoint, sh_point *point);

/* Quantities that sh_estimator_covariance gives behind the stiffness, in this order. */
enum {
    SH_QUANTITY_B,             /* inertia of the motor [kg.m2] */
    SH_QUANTITY_D_THETA,       /* viscous friction of the motor [N.m.s/rad] */
    SH_QUANTITY_TAU_COULOMB,   /* Coulomb friction of the motor, on its axis [N.m] */
    SH_QUANTITY_LOAD_FRICTION, /* friction per torque, of spring and motor [1] */
    SH_QUANTITY_HYSTERESIS,    /* half the height of the hysteresis loop [N.m] */
    SH_QUANTITY_LOST_TORQUE,   /* by which a dead zone reduces the torque of the spring beyond it:
                                  its half width times the stiffness [N.m] */
    SH_QUANTITIES
};

/* Gives the stiffness at points, and the quantities above, with their covariance, by the present estimate of
 * SH_METHOD_FILTERED_REGRESSION. The estimator does not change. The covariance is that of the regression: it
 * contains neither the gain of the torque nor, unlike sigma_std, errors of the deformation and of the place of a knee.
 * A quantity that is taken as exact, or whose columns are not used, has the variance 0.
 *
 * p           parameters that pass sh_parameters_check; the fixed ones as they were at the start
 * count       number of points, >= 0
 * phi         deformations [rad] [size: count]
 * setPoint    set-points [1] [size: count]
 * values      the estimates [size: count + SH_QUANTITIES]
 * per_gain    their change with the relative gain of the torque, d value / d gain [size: count + SH_QUANTITIES]
 * covariance  by rows [size: (count + SH_QUANTITIES)^2]
 *
 * Returns 0, or 1 with another method, which sets nothing.
 */
int sh_estimator_covariance(const sh_estimator *estimator, const sh_parameters *p, int count,
                            const sh_real *phi, const sh_real *setPoint, sh_real *values,
                            sh_real *per_gain, sh_real *covariance);

/* Checks a state from an external source, for example a file. Sizes, indices and flags of the state must be possible
 * after sh_estimator_start and sh_estimator_tick with these parameters. With such a state, a tick reads and writes no
 * memory outside the state, and ends. The check does not show whether the other numbers are correct. To detect wrong
 * numbers, save a checksum with the state.
 *
 * p  parameters, each in its range; the fixed ones as they were at the start
 *
 * Returns 0 if the state passes, else 1.
 */
int sh_estimator_check(const sh_estimator *estimator, const sh_parameters *p);

/* Definition of the struct sh_estimator, so that you can declare a variable of this type. */
#include "sigmahat_state.h"

#ifdef __cplusplus
}
#endif
#endif
