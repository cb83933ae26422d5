/* What an estimator stores from one tick to the next: the struct of each block of c/.
 *
 * Nothing here is for users, who include sigmahat.h: with every version these structs may change.
 * They are in a header that is installed because the caller provides the memory. Members named
 * `work` have no meaning between two calls; they are here so that the stack can be small.
 */
#ifndef SIGMAHAT_STATE_H
#define SIGMAHAT_STATE_H

/* Method Paper2011: ud_factor.h, least_squares.h, kinematic_kalman.h, torque_residual.h,
 * paper2011.c
 */

enum {
    SH_MAX_PARAMETERS = SH_MAX_BASIS,
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
    sh_real theta_w_s, q_w_s; /* (11): velocity of one encoder count per sample [rad/s] */
    sh_kinematic_kalman theta, q;
    sh_torque_residual residual;
    sh_real settling; /* time until r_e is right again after a gap [s] */
} sh_paper2011_filters;

typedef struct {
    sh_paper2011_filters filters;
    sh_least_squares rls;
    struct {
        sh_real F[SH_MAX_PARAMETERS], dF[SH_MAX_PARAMETERS];
    } work;
} sh_paper2011_state;

/* Method FilteredRegression: state_variable_filter.h, motion_sign.h, information.h, columns.h,
 * signals.h, sample_variance.h, blocks.h, posterior.h, forgetting.h, passes.h
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

/* Largest number of columns of the regression: those of the basis, and the others of columns.h. A
 * smaller one, given to the compiler, saves memory where priors of 0 remove columns.
 */
#ifndef SH_MAX_COLUMNS
#define SH_MAX_COLUMNS (SH_MAX_BASIS + 24)
#endif
enum {
    SH_SIDES = 2, /* right-hand sides of the regression: the change of y with the gain of the
                           torque, and y */
    SH_SIDE_GAIN = 0,
    SH_SIDE_Y = 1,
    SH_MAX_ENTRIES = SH_MAX_COLUMNS + SH_SIDES, /* of a row */
    SH_MAX_TRIANGLE = SH_MAX_COLUMNS * (SH_MAX_COLUMNS - 1) / 2 + SH_SIDES * SH_MAX_COLUMNS,
    SH_PLAYS = 3, /* widths of hysteresis, and of dead zones */
    SH_GROUPS = 6 /* groups of columns: 0 is always used, the others if the data ask for them */
};

/* Information of samples: sum of w x x' = U' D U, see information.h. */
typedef struct {
    int size; /* number of columns */
    sh_real D[SH_MAX_COLUMNS];
    sh_real U[SH_MAX_TRIANGLE]; /* row i: columns i + 1 .. size - 1, then the sides */
    sh_real rest;               /* sum of w y^2 that no parameter explains */
} sh_information;

/* A column of the regression. */
typedef struct {
    int kind;      /* SH_COLUMN_*, columns.h */
    int index;     /* for a product of powers: i SH_MAX_M + j, where its coefficient is eta[i][j] of
                      sh_estimate; for SH_COLUMN_DAMPING: the power of the set-point; else 0 */
    sh_real prior; /* std deviation of its coefficient, by which the column is multiplied */
    sh_real unit;  /* for a product of powers: what its coefficient is multiplied by to get that of
                      sh_estimate; else 0 */
} sh_column;

/* Prior and data, weighted by the misfit, in the order of its own columns. */
typedef struct {
    sh_information information;
    int column[SH_MAX_COLUMNS]; /* which column of the data each of its own is */
    int coulomb, inertia;       /* places of these among its own, -1 if none */
    sh_real weight;             /* of the data, one over the variance factor of the misfit [1] */
    sh_real surplus;            /* information about b that is rounding, still contained [1] */
    sh_real removed;            /* removed so far [1] */
    sh_real spread;             /* variance of both, as it acts on the estimate of b [1] */
} sh_posterior;

/* Blocks of samples, blocks.h. */
typedef struct {
    sh_information all;          /* of blocks, parameters constant */
    sh_information walking;      /* of blocks, friction may drift */
    sh_information recent;       /* of the last blocks, with the prior */
    sh_real count, recent_count; /* effective number of blocks [1] */
    sh_real gained; /* duration of the blocks since the last fading, without what repeats [s] */
    sh_real length; /* samples of a block */
    sh_real energy, energy_second; /* share of white noise that H, and s^2 H [1/s4], leave in a
                                      block */
    sh_real samples;               /* in the block so far */
    sh_real sum[SH_MAX_ENTRIES];   /* of weighted rows */
    sh_real weight, weight_window; /* sums of w h and w h^2, for the window h */
    sh_real window, window_square; /* sums of h and h^2 */
    sh_real independent;           /* sum of h^2 over what errors that last add to the variance */
    sh_real rounding;              /* sum of squares of the rounding of theta [rad2] */
} sh_blocks;

/* What a gap in the samples does not end. A refused sample leaves it as it was. */
typedef struct {
    sh_real play[SH_PLAYS];        /* states of the play operators [rad] */
    sh_real phi, phi_min, phi_max; /* deformation: last, least and largest [rad] */
    sh_real resting;               /* samples since phi changed */
    sh_real unsure;                /* samples for which the sign of the velocity has been unknown */
    sh_real settling;              /* time until the filters have forgotten their start [s] */
    sh_real starting; /* time left in which samples may show that the motor was moving [s] */
    sh_real rough;    /* mean square of the noise of theta, from its fourth differences [rad2] */
    sh_real excess, excess_mean; /* noise over what rounding explains, now and its mean [1] */
} sh_history;

/* The method. */
typedef struct {
    int modality;        /* of the last good sample */
    int begun;           /* 0: the filters start with the next sample */
    int has_nominal;     /* 1: a curve rls.eta_0 is given */
    int size;            /* number of columns */
    int alternate;       /* samples modulo 2: a pass advances with every second one */
    int row;             /* next row of `frozen` that `build` takes */
    int trial;           /* group that the present pass tries; 0: it changes the estimate */
    int last_trial;      /* group that was tried last */
    int friction_drifts; /* 1: the data show that friction changes */
    int stiffness_known; /* 1: columns that need the stiffness have an effect */
    int used[SH_GROUPS]; /* 1: the group is used */
    sh_column column[SH_MAX_COLUMNS];
    sh_real count, count_q;                 /* resolution of theta and q [rad] */
    sh_filter_design design;                /* of all filters */
    sh_real gain_second;                    /* variance of s^2 H of white noise of variance 1
                                                    [1/s4] */
    sh_state_variable_filter theta, torque; /* measured signals */
    sh_state_variable_filter friction;      /* sign of the velocity */
    sh_state_variable_filter unknown;       /* share of the sample in which it is unknown */
    sh_state_variable_filter nominal;       /* torque of the curve rls.eta_0 */
    sh_state_variable_filter filter[SH_MAX_COLUMNS];
    sh_motion_sign motion;
    sh_real torque_before;   /* torque of the last sample [N.m] */
    sh_real theta_before[5]; /* the last positions, for differences [rad] */
    sh_history history;
    sh_real R;                   /* variance of the last sample [(N.m)2] */
    sh_information data, frozen; /* all samples, and a copy for the present pass */
    sh_posterior live, build;    /* the estimate, and the next one while it is built */
    sh_blocks blocks;
    sh_real since;                       /* samples since the data were last faded */
    sh_real surplus, spread;             /* of all samples, see sh_posterior */
    sh_real rounding;                    /* information about sigma that is only rounding of phi, of
                                            all samples [(rad/N.m)2] */
    sh_real q, variance_factor;          /* misfit squared, and the factor of the variances [1] */
    sh_real largest_deformation;         /* above it, nothing is claimed [rad] */
    sh_real y;                           /* of the last sample [N.m] */
    sh_real delay;                       /* estimated delay of the torque [s] */
    sh_real sigma;                       /* estimated stiffness [N.m/rad] */
    sh_real tau_nominal, sigma_nominal;  /* of the curve rls.eta_0 at this sample [N.m, N.m/rad] */
    sh_real nominal_curve[SH_MAX_BASIS]; /* rls.eta_0 in the units of scaled_basis.h [N.m] */
    sh_real beta[SH_MAX_COLUMNS];        /* estimate by column, in std deviations of the priors */
    struct {
        sh_real F[SH_MAX_COLUMNS], dF[SH_MAX_COLUMNS]; /* inputs of the columns, their slopes */
        sh_real x[SH_MAX_ENTRIES], row[SH_MAX_ENTRIES];
        sh_real own[SH_MAX_COLUMNS], v[SH_MAX_COLUMNS];
        sh_real basis[SH_MAX_BASIS], slope[SH_MAX_BASIS]; /* scaled_basis.h */
    } work;
} sh_regression_state;

/* The estimator. */
struct sh_estimator {
    int started;     /* 1: there was a good sample */
    sh_real skipped; /* ticks skipped since the last good sample */
    union {
        sh_paper2011_state paper2011;
        sh_regression_state regression;
    } method;
};

#endif
