/* The columns of the regression of the method FilteredRegression.
 *
 * Take the motor (3) with Coulomb friction, and let its data B and D_theta have the relative errors
 * b and d:
 *
 *     (1+b) B gamma theta'' + (1+d) D_theta gamma theta' + tau_C sign(theta')
 *         - tau_e / gamma = tau .
 *
 * With both sides through H(s) (state_variable_filter.h, index f) and with tau_e = F' eta of (21),
 * this is the regression
 *
 *     y = gamma (B gamma theta''_f + D_theta gamma theta'_f - tau_f)
 *       = F_f' eta - gamma^2 D_theta theta'_f d - gamma^2 B theta''_f b
 *         - |gamma| sign(theta')_f tau_C .
 *
 * If the flexibility torque is measured (SH_MODALITY_SENSOR) or modelled (SH_MODALITY_MODEL), y is
 * that torque through H, and the columns of the motor are zero.
 *
 * Real joints have more than this model. Each kind of column stands for one such thing. Its
 * coefficient has the prior mean 0 and a std deviation of sh_parameters.prior, by which the column
 * is multiplied: so all coefficients beta have the prior N(0, 1). With a prior of 0 there is no such
 * column.
 *
 * To add a kind: its name here, and in columns.c its traits, its prior in list_columns, and its
 * signal in input_of, or, if it is not a filtered signal, in entry_of.
 */
#ifndef SH_COLUMNS_H
#define SH_COLUMNS_H

#include "sigmahat.h"

enum {
    SH_COLUMN_BASIS,   /* torque: scaled_basis.h */
    SH_COLUMN_NOMINAL, /* torque: the curve rls.eta_0 */
    SH_COLUMN_BIAS,    /* 1: bias of the torque, zero of the deformation, uneven friction */
    SH_COLUMN_DAMPING, /* phi', and phi' l^(m-1) with the set-point l: damping of the spring */
    SH_COLUMN_SIN_Q,   /* sin q, cos q: link encoder that is not centred */
    SH_COLUMN_COS_Q,
    SH_COLUMN_LOAD,      /* -|tau_e| sign(theta'): friction that grows with the load */
    SH_COLUMN_DRIVE,     /* -|gamma tau_f| sign(theta')_f: and with the torque of the motor */
    SH_COLUMN_DELAY,     /* derivative of the torque: it is late or early */
    SH_COLUMN_REVERSAL,  /* derivative of sign(theta'): friction reverses late or early */
    SH_COLUMN_POWER,     /* torque: more powers of phi */
    SH_COLUMN_SET_POWER, /* torque: phi l^m, one more power of the set-point */
    SH_COLUMN_GAP_1,     /* torque: clip(phi, h) / h, dead zones (backlash) of three widths */
    SH_COLUMN_GAP_2,
    SH_COLUMN_GAP_3,
    SH_COLUMN_PLAY_1, /* elastic-plastic elements of three widths: hysteresis (Prandtl, Ishlinskii) */
    SH_COLUMN_PLAY_2,
    SH_COLUMN_PLAY_3,
    SH_COLUMN_SIN_M, /* sin, cos of gamma theta: motor encoder that is not centred */
    SH_COLUMN_COS_M,
    SH_COLUMN_VISCOUS, /* d */
    SH_COLUMN_COULOMB, /* tau_C */
    SH_COLUMN_INERTIA, /* b. It is the last one, see posterior.h */
    SH_COLUMN_KINDS
};

/* Whether a nominal curve rls.eta_0 is given. */
int sh_has_nominal_curve(const sh_parameters *p);

/* Whether the flexibility torque is measured or modelled, and not computed from the motor's. */
int sh_is_measured(const sh_parameters *p);

/* Number of columns for these parameters. May be larger than SH_MAX_COLUMNS. */
int sh_columns_count(const sh_parameters *p);

/* Writes the columns for these parameters to column [size: sh_columns_count(p)]. */
void sh_columns_list(const sh_parameters *p, sh_column *column);

/* Sets the columns and the nominal curve. There must not be more than SH_MAX_COLUMNS. */
void sh_columns_start(sh_regression_state *state, const sh_parameters *p);

/* The group of a column, 0: it is always used. */
int sh_column_group(const sh_column *column);

/* Whether the column is one of the group, and the deformation has been large enough to distinguish
 * it from the spring.
 */
int sh_column_can_join(const sh_regression_state *state, const sh_parameters *p,
                       const sh_column *column, int group);

/* Whether the column is part of the torque of the spring. */
int sh_column_is_torque(const sh_column *column);

/* Whether the column is one of the dead zones. */
int sh_column_is_gap(const sh_column *column);

/* Whether the column is in the equation above, and does not stand for something more. */
int sh_column_is_of_equation(const sh_column *column);

/* Sets the signals of the columns before the filter, and their slopes over phi, in work.F and
 * work.dF; and torque and stiffness of the nominal curve.
 *
 * theta, q   positions [rad]
 * phi        deformation [rad]
 * set_point  [1]
 */
void sh_columns_input(sh_regression_state *state, const sh_parameters *p, sh_real theta, sh_real q,
                      sh_real phi, sh_real set_point);

/* Moves the elements of hysteresis by a change of the deformation [rad]. */
void sh_columns_move_plays(sh_regression_state *state, const sh_parameters *p, sh_real change);

/* How the filter of a column takes its signal. */
enum {
    SH_SIGNAL_NONE,   /* it has no filter */
    SH_SIGNAL_LINEAR, /* linear between samples; it begins with a jump from 0, as the torque */
    SH_SIGNAL_STEADY, /* linear between samples; it begins as if it had been so before */
    SH_SIGNAL_MEAN    /* given by its mean over the sample */
};
int sh_column_signal(const sh_column *column);

/* Sets the row x [size: size + SH_SIDES] of the regression at the present state of the filters.
 *
 * Returns y [N.m]. The last entry of x is y less the torque of the nominal curve.
 */
sh_real sh_columns_row(const sh_regression_state *state, const sh_parameters *p, sh_real *x);

/* Removes from the row x what is noise of the torque, as far as it is known, where it would be
 * mistaken for friction: the noise of y and that of |tau_f| are the same.
 *
 * noise  share of y that is noise of the torque [N.m]
 *
 * Returns by how much this changes the prediction of y [N.m].
 */
sh_real sh_columns_remove_noise(const sh_regression_state *state, const sh_parameters *p,
                                sh_real noise, sh_real *x);

/* Torque of the spring for the estimate beta at the signals in work.F [N.m]. */
sh_real sh_columns_torque(const sh_regression_state *state);

#endif
