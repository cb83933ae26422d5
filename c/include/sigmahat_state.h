/* What an estimator stores from one tick to the next: the struct of each block of c/.
 *
 * Nothing here is for users, who include sigmahat.h: with every version these structs may change.
 * They are in a header that is installed because the caller provides the memory. Members named
 * `work` have no meaning between two calls; they are here so that the stack can be small.
 */
#ifndef SIGMAHAT_STATE_H
#define SIGMAHAT_STATE_H

/* Recursive least squares: ud_factor.h, least_squares.h */

enum {
    SH_MAX_MOTOR = 3, /* errors of motor data that are estimated together with the torque */
    SH_MAX_PARAMETERS = SH_MAX_BASIS + SH_MAX_MOTOR,
    SH_PANEL = 4, /* rows of U side by side in memory, see ud_factor.c */
    SH_MAX_ROWS = ((SH_MAX_PARAMETERS + SH_PANEL - 1) / SH_PANEL * SH_PANEL),
    SH_MAX_U = (SH_MAX_ROWS * SH_MAX_PARAMETERS - SH_MAX_ROWS * (SH_MAX_ROWS - SH_PANEL) / 2 +
                SH_PANEL) /* one column more than U has: the loops read it, and do not use it */
};

/* Factors of a covariance P = U D U'. */
typedef struct {
    sh_real D[SH_MAX_ROWS]; /* diagonal, >= 0 */
    sh_real U[SH_MAX_U];    /* unit upper triangular */
    struct {
        sh_real pairs[SH_MAX_ROWS][2];
        sh_real g[SH_MAX_ROWS], f[SH_MAX_ROWS], rho[SH_MAX_ROWS + 1];
    } work;
    int size; /* number of parameters, 1..SH_MAX_PARAMETERS */
} sh_ud_factor;

/* The recursion. */
typedef struct {
    sh_real eta[SH_MAX_ROWS];     /* estimate */
    sh_real eta_low[SH_MAX_ROWS]; /* digits of the estimate below the last digit of eta, so that
                                     the rounding of millions of small updates does not add up */
    sh_ud_factor P;               /* covariance */
} sh_least_squares;

/* Method Paper2011: kinematic_kalman.h, torque_residual.h, paper2011.c */

/* Kalman filter of one axis. */
typedef struct {
    sh_real z;             /* measured position [rad] */
    sh_real lag;           /* estimated position less the measured one [rad]: a small number, so
                              that the filter loses no digits however far the axis has turned */
    sh_real x_dot;         /* velocity [rad/s] */
    sh_real dx, dx_dot;    /* change of position and velocity with the last sample */
    sh_real P11, P12, P22; /* covariance of (x, x_dot) */
} sh_kinematic_kalman;

/* Residual of one motor. */
typedef struct {
    sh_real r_e; /* (8), on the motor axis [N.m] */
    sh_real tau; /* motor torque of the last sample [N.m] */
} sh_torque_residual;

/* First stage of the paper's method: filters and residual. */
typedef struct {
    sh_kinematic_kalman theta, q;
    sh_torque_residual residual;
    sh_real settling; /* time until r_e is right again after a gap [s] */
} sh_paper2011_state;

/* Method MatchedFilter: state_variable_filter.h, motion_sign.h, rounding_bias.h,
 * matched_regression.h
 */

/* What all filters of one corner frequency and sample period share. */
typedef struct {
    sh_real w;       /* corner frequency [rad/s] */
    sh_real T;       /* sample period [s] */
    sh_real lag;     /* 1 / (w T): delay of one stage behind a ramp [samples] */
    sh_real keep[3]; /* share that is left after T of the deviation of a stage itself, and of the
                        stages one and two before it */
} sh_filter_design;

/* Filter of one signal, in the unit of the signal. */
typedef struct {
    sh_real input;     /* last sample */
    sh_real behind[3]; /* input less output of each stage: small numbers, so that derivatives lose
                          no digits however far the signal is from zero */
} sh_state_variable_filter;

/* Direction of motion of one motor. */
typedef struct {
    sh_real position;  /* at the last change of position [rad] */
    sh_real change;    /* last change of position [rad], 0 before the first */
    sh_real direction; /* sign at the last change, -1..1 */
    sh_real waiting;   /* samples since the last change */
    sh_real given;     /* sum of the signs reported for these samples */
    sh_real sign;      /* mean sign of the velocity over the last sample, -1..1; at a reversal it
                          also corrects the samples before, and may be larger */
    sh_real unknown;   /* 0 if the sign is known, 1 if not, more if samples before were wrong too */
} sh_motion_sign;

/* Information about a parameter that comes from the rounding of its regressor [1]. */
typedef struct {
    sh_real surplus; /* still in the recursion */
    sh_real removed; /* removed so far */
} sh_rounding_bias;

/* The regression. */
typedef struct {
    int basis;                              /* number of coefficients of the torque */
    int modality;                           /* of the last good sample */
    int begun;                              /* 0: the filters start with the next sample */
    sh_real eta_0[SH_MAX_BASIS];            /* prior mean */
    sh_real count, count_q;                 /* resolution of theta and q [rad] */
    sh_filter_design design;                /* of all filters */
    sh_state_variable_filter theta, torque; /* measured signals */
    sh_state_variable_filter friction;      /* sign of the velocity */
    sh_state_variable_filter unknown;       /* share of the sample in which it is unknown */
    sh_state_variable_filter column[SH_MAX_BASIS];
    sh_motion_sign motion;
    sh_rounding_bias bias; /* of the relative error b of B */
    sh_real rounding; /* variance of the filtered theta'' for a rounding of variance 1 [1/s4] */
    sh_real phi;      /* deformation at the last sample [rad] */
    sh_real resting;  /* samples since phi changed */
    sh_real unsure;   /* samples for which the sign of the velocity has been unknown */
    sh_real settling; /* time until the filters have forgotten their start [s] */
    sh_real starting; /* time left in which samples may show that the motor was moving [s] */
    struct {
        sh_real F[SH_MAX_PARAMETERS], direction[SH_MAX_PARAMETERS];
    } work;
} sh_matched_regression;

/* The estimator. */
struct sh_estimator {
    int started;          /* 1: there was a good sample */
    sh_real skipped;      /* ticks skipped since the last good sample */
    sh_least_squares rls; /* in the units of the method */
    union {
        sh_paper2011_state paper2011;
        sh_matched_regression matched;
    } method;
    sh_real units[SH_MAX_BASIS]; /* what the coefficients of the torque are multiplied by to get
                                    from the units of the method to those of sh_estimate */
    struct {
        sh_real F[SH_MAX_PARAMETERS], dF[SH_MAX_PARAMETERS]; /* zero beyond the basis */
        sh_real eta[SH_MAX_PARAMETERS];
    } work;
};

#endif
