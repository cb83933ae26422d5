/* Stiffness from a regression that has columns for the misfits of real joints, and whose
 * uncertainty includes the remaining misfit. A prototype of a next version of c/matched_filter; see
 * README.md.
 */
#ifndef EST_H
#define EST_H

#include "motion_sign.h"
#include "state_variable_filter.h"
#include "tri.h"

/* Settings. */
typedef struct {
    sh_real T, bandwidth, slow, drift; /* as sh_matched_settings */
    sh_real memory;                    /* time constant with which data that contradict the model
                                             are forgotten [s] */
    int measured, symmetric, n, m;
    sh_real range_phi, range_set;
    sh_real noise; /* of the torque [N.m] */
    sh_real gamma, B, D;
    sh_real count, count_q; /* [rad] */
    sh_real eta_0[40];      /* nominal curve, in units of the scaled basis [N.m] */
    sh_real confidence;
    struct {
        sh_real tau_e, nominal, D, B, tau_coulomb; /* as today */
        sh_real torque_gain;                       /* [1] considered, not estimated */
        sh_real bias;            /* torque bias, zero of phi, uneven friction: share of tau_e [1] */
        sh_real lag;             /* damping / stiffness; encoders read at different times [s] */
        sh_real load_friction;   /* [1] */
        sh_real eccentric;       /* link encoder [rad] */
        sh_real delay;           /* torque late or early [s] */
        sh_real reversal;        /* friction reverses late or early: time [s] times tau_coulomb */
        sh_real power;           /* candidates: more powers, share of tau_e [1] */
        sh_real gap;             /* dead zone, share of tau_e [1] */
        sh_real hysteresis;      /* play, share of tau_e [1] */
        sh_real eccentric_motor; /* [rad] behind the gear */
    } prior;
} est_settings;

/* Why the estimate is not confident. */
enum {
    EST_NONE = 0,
    EST_MISFIT = 2,       /* uncertain because the model does not hold */
    EST_NOT_EXCITED,      /* uncertain because the motion was too small */
    EST_INERTIA_OUTSIDE,  /* b beyond 3 priors */
    EST_FRICTION_OUTSIDE, /* d or tau_C beyond 3 priors */
    EST_NEGATIVE,         /* stiffness not positive */
    EST_OUT_OF_RANGE      /* deformation beyond the range */
};

enum { EST_PLAYS = 3, EST_KINDS = 24 };
enum { EST_GROUPS = 6 }; /* candidates: more powers, set-point, dead zone, play, motor encoder */

typedef struct {
    int kind, index, group; /* group 0: always on; else one of the candidates */
    int torque;             /* 1: part of the torque of the spring */
    sh_real prior;          /* std deviation, by which the column is multiplied */
} est_column;

/* A posterior: prior and data / kappa^2, in the order of its columns. */
typedef struct {
    tri t;
    int column[TRI_MAX];            /* which column of the data each of its own is */
    int C, B, D;                    /* places of the motor data in it, -1 if none */
    sh_real weight;                 /* 1 / kappa^2 */
    sh_real surplus, taken, square; /* rounding in the inertia column: not yet taken out, taken out,
                                       variance of its squares */
    int pair;                       /* group on trial, the last columns; 0: none */
} est_posterior;

typedef struct {
    est_settings s;
    int columns;
    est_column column[TRI_MAX];
    int place[EST_KINDS]; /* first column of each kind, -1: none */
    int on[EST_GROUPS];
    sh_filter_design design;
    sh_real rounding; /* noise gain of s^2 H */
    sh_state_variable_filter theta, torque, friction, unknown, filter[TRI_MAX];
    sh_motion_sign motion;
    sh_real play[EST_PLAYS], least, most, span; /* of the deformation [rad] */
    sh_real phi, resting, unsure, settling, starting;
    int begun;
    sh_real last[5];                         /* positions of the motor, for fourth differences */
    tri data, frozen, block, walking, fresh; /* walking: blocks, if friction may drift;
                                               fresh: recent blocks */
    est_posterior live, build;
    int row; /* next row of `frozen`; all: pass is over */
    int turn, next_pair, wait;
    sh_real sum[TRI_MAX + TRI_SIDES], weight, weight2, fourth, window1, window2; /* block so far */
    sh_real length, energy[3]; /* of blocks [samples, 1] */
    int in_block;
    sh_real fresh_blocks;
    sh_real blocks;          /* effective number */
    sh_real surplus, square; /* all, see est_posterior */
    sh_real q, kappa2, rough, excess, excess_mean;
    int drifts;                   /* 1: friction drifts */
    sh_real recent;               /* mean square of recent predictions' errors */
    sh_real R, last_x[TRI_MAX];   /* of the last sample: variance, columns */
    sh_real y;                    /* torque of the spring by the motor data, filtered [N.m] */
    sh_real late;                 /* estimated delay of the torque [s] */
    int known;                    /* 1: relative uncertainty of the stiffness is below KNOWN */
    sh_real sigma, beta[TRI_MAX]; /* by column of the data, units of the prior */
    struct {
        sh_real in[TRI_MAX], dF[TRI_MAX], x[TRI_MAX + TRI_SIDES], row[TRI_MAX + TRI_SIDES];
        sh_real v[TRI_MAX], own[TRI_MAX];
    } work;
} est;

typedef struct {
    sh_real sigma, sigma_std, tau_e, misfit, claim;
    sh_real d, b, tau_coulomb, bias, lag, load_friction, delay, hysteresis;
    sh_real by_gain; /* d ln sigma / d ln gain */
    int confident, doubt, active, on;
    sh_real sum_std;
} est_output;

void est_defaults(est_settings *s);
void est_start(est *e, const est_settings *s);
void est_tick(est *e, sh_real theta, sh_real q, sh_real set_point, sh_real torque, est_output *out);

void est_ask(est *e, sh_real phi, sh_real set_point, est_output *out);

#endif
