/* The state of an estimator from one tick to the next: a struct for each block of c/.
 *
 * Users include only sigmahat.h, because the structs of this header may change with every version. This header is
 * installed, because the caller provides the memory for the structs. Members named `work` are only valid within a call.
 */
#ifndef SIGMAHAT_STATE_H
#define SIGMAHAT_STATE_H

/* Method Paper2011: least_squares.h, kinematic_kalman.h, torque_residual.h, paper2011.c */

enum {
    SH_MAX_PARAMETERS = SH_MAX_BASIS,
    SH_MAX_ROWS = (SH_MAX_PARAMETERS + 1) / 2 * 2, /* whole pairs, see least_squares.c */
    SH_MAX_U = SH_MAX_ROWS * SH_MAX_ROWS / 2
};

/* What belongs to a column of U. D and f are neighbours, and the entries of two columns are not: a compiler would combine
 * these to one vector. The update of a column would then wait for the next column.
 */
typedef struct {
    sh_real D; /* entry of the diagonal, >= 0 */
    sh_real f; /* entry of U' F, work */
} sh_ud_column;

/* Factors of a covariance P = U D U'. */
typedef struct {
    sh_ud_column columns[SH_MAX_ROWS];
    sh_real PF[SH_MAX_ROWS]; /* P F from before the update, work */
    sh_real least;           /* not above any entry of D */
    int size;                /* number of parameters, 1..SH_MAX_PARAMETERS */
    sh_real U[SH_MAX_U];     /* unit upper triangular, see least_squares.c */
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
} sh_paper2011_state;

/* Method FilteredRegression, in the folder of this name. */

/* Common data of all filters with one corner frequency and sample period. */
typedef struct {
    sh_real w;       /* corner frequency [rad/s] */
    sh_real T;       /* sample period [s] */
    sh_real keep[3]; /* share that is left after T of the deviation of a stage itself, and of the
                        stages one and two before it */
    sh_real rise[3]; /* deviation of each stage after T behind a signal that rises by 1 */
} sh_filter_design;

/* Direction of motion of one motor. */
typedef struct {
    sh_real position;  /* position after its last change [rad] */
    sh_real change;    /* last change of position [rad], 0 before the first */
    sh_real direction; /* sign at the last change, -1..1 */
    sh_real waiting;   /* samples since the last change */
    sh_real given;     /* sum of the signs reported for these samples */
    sh_real sign;      /* mean sign of the velocity over the last sample, -1..1; at a reversal it
                          also corrects the samples before, and may be larger */
    sh_real unknown;   /* 0 if the sign is known, 1 if not, more if samples before were wrong too */
} sh_motion_sign;

enum {
    SH_RIGHT_SIDES = 2, /* right-hand sides of the regression */
    SH_RIGHT_GAIN = 0,  /* change of y with the relative gain of the torque */
    SH_RIGHT_Y = 1,     /* y */
    SH_MAX_ROW = SH_MAX_COLUMNS + SH_RIGHT_SIDES, /* entries of a row: columns, right-hand sides */
    SH_MAX_TRIANGLE = SH_MAX_COLUMNS * (SH_MAX_COLUMNS - 1) / 2 + SH_RIGHT_SIDES * SH_MAX_COLUMNS,
    SH_WIDTHS = 3, /* half widths of dead zones, and of elements of hysteresis */
    SH_GROUPS = 7  /* groups of columns: 0 is always used, the others if the data ask for them */
};

/* Information of samples: sum of w x x' = U' D U, see information.h. */
typedef struct {
    int size; /* number of columns */
    sh_real D[SH_MAX_COLUMNS];
    sh_real U[SH_MAX_TRIANGLE]; /* row i: columns i + 1 .. size - 1, then the right-hand sides */
    sh_real squares;            /* residual sum of squares of y [1] */
} sh_information;

/* Variances of two combinations of the coefficients. */
typedef struct {
    sh_real first, second;
} sh_variances;

/* A column of the regression. */
typedef struct {
    short kind;    /* of the table in columns.c */
    short i, j;    /* power of the torque: its coefficient is eta[i][j]; damping: power j of the
                      set-point; dead zone and hysteresis: half width i; knee:
                      number i of its place; else 0 */
    sh_real prior; /* std deviation of its coefficient, by which the column is multiplied */
    sh_real unit;  /* power of the torque: its coefficient times this is that of sh_estimate */
    sh_real place; /* half width of dead zone or hysteresis, or place of a knee, over range.phi */
} sh_column;

/* All columns. */
typedef struct {
    int size;     /* number of columns */
    int spring;   /* the first ones, so many, make up the torque of the spring */
    int knees;    /* first column whose slope may change at once */
    int filtered; /* the first ones, so many, have a signal: the torque of the spring, or a filter */
    int friction;    /* first column of friction; the last one is before inertia */
    int inertia;     /* the last one; the size if there is none */
    int has_nominal; /* 1: a curve rls.eta_0 is given */
    sh_column column[SH_MAX_COLUMNS];
} sh_columns;

/* Signals of the filters. Signals before SH_FILTER_NOMINAL start as if always constant; the others start at 0. */
enum {
    SH_FILTER_THETA,
    SH_FILTER_PHI,     /* deformation */
    SH_FILTER_PHI_SET, /* deformation times the highest power of the set-point */
    SH_FILTER_SIN_M,   /* sine and cosine of the angle of the motor's encoder */
    SH_FILTER_COS_M,
    SH_FILTER_NOMINAL, /* torque of the curve rls.eta_0 */
    SH_FILTER_TORQUE,
    SH_FILTER_SIGN,    /* of the velocity */
    SH_FILTER_UNKNOWN, /* share of the sample in which the sign is unknown */
    SH_FILTER_LOAD,    /* -|tau_e| s, friction that grows with the load */
    SH_FILTERS,        /* behind them: the columns whose entry is the output of a filter */
    SH_MAX_FILTERS = SH_FILTERS + SH_MAX_COLUMNS
};

/* States of all filters, each in the unit of its signal. The same state of all filters is one array, so that compilers
 * can process several filters at the same time.
 */
typedef struct {
    sh_real input[SH_MAX_FILTERS]; /* last sample */
    /* Input less output of each stage: small numbers, so that derivatives lose no digits however far
     * the signal is from zero. */
    sh_real behind[3][SH_MAX_FILTERS];
} sh_filters;

/* Signals behind their filters, and their derivatives by the time. */
typedef struct {
    sh_real output[SH_FILTERS], first[SH_FILTERS], second[SH_FILTERS];
} sh_filtered;

/* Data of the past. A gap in the samples resets only `settling`, and a rejected sample changes none of them. */
typedef struct {
    sh_real stop[SH_WIDTHS];       /* states of the stop operators of hysteresis [rad] */
    sh_real phi, phi_min, phi_max; /* deformation: last, least and largest [rad] */
    sh_real resting;               /* samples since phi changed */
    sh_real unsure;                /* samples for which the sign of the velocity has been unknown */
    sh_real settling;              /* time until the filters have forgotten their start [s] */
    sh_real rough; /* mean square of the noise of theta, from its fourth differences [rad2] */
} sh_history;

/* The first positions, which show whether the motor was at rest, rest.c. */
typedef struct {
    int taken, most; /* number of samples so far; number of samples before the test ends */
    int next;        /* number of the next sample that is compared with that of half the number */
    sh_real first, middle; /* position of the first sample, and of the last one compared [rad] */
} sh_rest;

/* Signals and their filters, which all have the same design. */
typedef struct {
    int begun;              /* 0: the filters start with the next sample */
    sh_real count, count_q; /* resolution of theta and q [rad] */
    sh_filter_design design;
    int decimation; /* K: samples of a row */
    /* Variance of the mean of K samples if white noise of variance 1 is filtered by H [1], by s^2 H [1/s4]: */
    sh_real gain, gain_second;
    sh_filters filters;
    sh_motion_sign motion;
    sh_real torque_before;   /* torque of the last sample [N.m] */
    sh_real theta_before[5]; /* the last positions, for differences [rad] */
    sh_history history;
} sh_signals;

/* Signals of the gate, whose samples are tested. */
enum {
    SH_GATE_THETA,
    SH_GATE_PHI,       /* deformation */
    SH_GATE_TORQUE,    /* of the motor, or measured, as the modality is */
    SH_GATE_SET_POINT, /* less the center of its range; not without a polynomial in the set-point */
    SH_GATE_SIGNALS
};

/* A signal of the gate, each number in the unit of the signal. */
typedef struct {
    sh_real last, step; /* last accepted sample, and its difference to the sample before it */
    sh_real newest;     /* last sample, accepted or not */
    sh_real peak;       /* largest innovation of late */
    sh_real jump;       /* innovation with which the present refusals began */
    int refused;        /* samples since the last accepted one */
    /* Constant: smallest limit of the innovation at the start, and later; largest possible sample. */
    sh_real scale, least, largest;
} sh_gate_signal;

/* What a joint can give, from its last samples, gate.c. */
typedef struct {
    int samples; /* since the start or a gap */
    int skipped; /* ticks skipped, as the gate has seen them; the estimator skipped more if samples are missing */
    sh_gate_signal signal[SH_GATE_SIGNALS];
} sh_gate;

/* What the next row needs of the estimate at the last tick. */
typedef struct {
    sh_real y;           /* y of the last tick, less the error of the last row [N.m] */
    sh_real sigma;       /* stiffness [N.m/rad] */
    sh_real delay;       /* of the torque [s] */
    int stiffness_known; /* 1: columns that need the stiffness have an effect */
} sh_feedback;

/* Means over the K samples of the next row: each sample taken so far has added 1/K of itself. */
typedef struct {
    int samples;                    /* taken so far */
    sh_real rough;                  /* mean noise of theta [rad2] */
    sh_real moved;                  /* share of the samples with which theta changed [1] */
    sh_filtered filtered;           /* of the signals */
    sh_real output[SH_MAX_COLUMNS]; /* outputs of the filters of the columns */
} sh_mean;

/* The last row. */
typedef struct {
    sh_real x[SH_MAX_ROW]; /* columns, then right-hand sides */
    sh_real w;             /* weight [1/(N.m)2] */
    sh_real lasting;       /* factor in 1/w by errors that last, >= 1 */
    sh_real rough;         /* mean of the noise of theta [rad2] */
    sh_real moved;         /* share of the samples with which theta changed [1] */
    sh_real epsilon, rho;  /* error of the prediction [N.m], its variance over 1/w [1] */
} sh_row;

/* Effect of the torque noise in the column that is computed from the motor torque. The members are the terms that this
 * noise adds to the normal equation of the coefficient.
 */
typedef struct {
    sh_real information; /* [1] */
    sh_real gain;        /* part in the right-hand side SH_RIGHT_GAIN [1] */
} sh_column_noise;

/* Posterior from the prior and the data, weighted by the misfit. A posterior has its own order of the columns. */
typedef struct {
    sh_information information;
    short column[SH_MAX_COLUMNS]; /* which column of the data each of its own is */
    sh_real weight;               /* weight of the data, 1 / variance factor of the misfit [1] */
    sh_real surplus;              /* information about b that is rounding, still contained [1] */
    sh_real removed;              /* removed so far [1] */
    sh_real spread;               /* variance of surplus and removed, as it acts on b [1] */
} sh_posterior;

/* The estimate, coefficients.c. */
typedef struct {
    sh_real beta[SH_MAX_COLUMNS];     /* by column, in std deviations of the priors */
    sh_real per_gain[SH_MAX_COLUMNS]; /* change of beta with the relative gain of the torque */
    sh_real viscous, inertia;         /* relative errors of motor.D_theta and motor.B [1] */
    sh_real viscous_std;              /* std deviation of `viscous` at the last refit [1] */
} sh_coefficients;

/* A row that a later step takes, and its weight, which is negative for process noise; 0: there is none. */
typedef struct {
    sh_real x[SH_MAX_ROW], w;
} sh_sample;

/* All samples, samples.c. */
typedef struct {
    sh_information data;
    sh_real weights;         /* sum of the weights [1/(N.m)2] */
    sh_real surplus, spread; /* of all samples, see sh_posterior */
    sh_column_noise noise;
    sh_sample drift; /* process noise of friction for the next step */
} sh_samples;

/* The present block of rows, block.c. */
typedef struct {
    sh_real length;                /* rows of a block */
    sh_real duration;              /* of a block [s] */
    sh_real energy, energy_second; /* share of white noise that H, and s^2 H [1/s4], leave in a
                                      block */
    sh_real rows;                  /* so far */
    sh_real sum[SH_MAX_ROW];       /* of weighted rows */
    sh_real weight, weight_window; /* sums of w h and w h^2, for the window h */
    sh_real window, window_square; /* sums of h and h^2 */
    sh_real independent; /* sum of h^2 over the increase of the variance by errors that last */
    sh_real rounding;    /* sum of mean squares of the rounding of theta [rad2] */
} sh_block;

/* The mean row of the last full block, and what it counts for. */
typedef struct {
    sh_real x[SH_MAX_ROW];
    sh_real w;        /* weight, 1 / variance [1/(N.m)2] */
    sh_real count;    /* number of blocks without lasting errors with the same information, <= 1 */
    sh_real duration; /* of the block, times `count` [s] */
} sh_block_mean;

/* Hypotheses about the joint, which predict each block, bank.c. */
typedef struct {
    sh_information constant;                     /* prior and blocks, if the joint is as before */
    sh_information friction;                     /* the same, if friction drifts or has changed */
    sh_information spring;                       /* the same, if the spring has changed */
    sh_real error, friction_error, spring_error; /* of the last block, as the hypotheses
                                                    predicted it: squares over variances */
    sh_real prior; /* share of the prior that is left in the first two, 0..1 */
    sh_real count; /* effective number of blocks [1] */
    sh_real past;  /* number of blocks so far, also of forgotten ones, as far as it matters [1] */
    sh_real level; /* mean square of a block's error over its variance */
    /* Another spring: */
    sh_real blocks;   /* since the hypothesis began */
    sh_real evidence; /* of the change [1] */
    int following;    /* 1: a change was adopted, and the estimate does not contain it yet */
    /* Other friction: */
    int friction_drifts;     /* 1: the data show that friction changes slowly */
    sh_real friction_blocks; /* since the test of a sudden change began; 0: it has not */
    int widened;             /* next column of friction that gets the variance of its prior */
    sh_real preference;      /* evidence for another spring over other friction */
    sh_sample drift;         /* process noise of friction for the next step */
} sh_bank;

/* How far the blocks contradict the model, misfit.c. */
typedef struct {
    sh_real square;          /* reduced chi-square of the blocks [1] */
    sh_real variance_factor; /* factor of the variances, kappa^2 [1] */
    sh_real usual, judged;   /* usual misfit: mean, and of how many blocks [1] */
    sh_real duration; /* of the blocks since data were last forgotten, or might have been [s] */
} sh_misfit;

/* The next posterior while it is computed from all data, refit.c. */
typedef struct {
    sh_posterior posterior;
    int unread;     /* rows of the data, the first ones, that have not been read */
    int is_open;    /* 1: the posterior takes new rows; 0: it is in use, or a trial that is over */
    sh_sample rest; /* what the rows of the data that have not been read left of the newest row */
    int trial; /* group that the refit tries, behind end_refit() that of the next refit; 0: none, the
                  refit changes the estimate */
    int last_trial;      /* group that was tried last */
    int used[SH_GROUPS]; /* 1: the group is used */
    sh_real pause;       /* since the end of the last refit [s] */
} sh_refit;

/* What the tick does next, schedule.c. */
typedef struct {
    int tick;        /* ticks since the row, up to the number in which its jobs are done */
    int block_job;   /* next job of the last full block */
    int refit_job;   /* next job of the refit behind the rows of the data */
    int interrupted; /* 1: there is a gap behind the row, which therefore belongs to no block */
    sh_real time;    /* since forgetting and drift were last applied [s] */
} sh_schedule;

/* The method: its parts, and what the tick itself knows. */
typedef struct {
    int modality; /* of the last good sample */
    sh_columns columns;
    sh_gate gate;
    sh_signals signals;
    sh_rest rest;
    sh_mean mean;
    sh_row row;
    sh_samples samples;
    sh_posterior posterior; /* the estimate */
    sh_refit refit;
    sh_block block;
    sh_block_mean block_mean;
    sh_bank bank;
    sh_misfit misfit;
    sh_schedule schedule;
    sh_feedback feedback;
    sh_coefficients coefficients; /* of the posterior */
    sh_variances variances;       /* of the torque of the spring [(N.m)2], and of the stiffness
                               [(N.m/rad)2], if the gain is right */
    int change_age; /* ticks since the last change of the spring, -1 if there was none */
} sh_regression_state;

/* The estimator. */
struct sh_estimator {
    int started; /* 1: there was a good sample */
    int skipped; /* ticks skipped since the last good sample */
    union {
        sh_paper2011_state paper2011;
        sh_regression_state regression;
    } method;
};

#endif
