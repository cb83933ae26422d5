/* Interfaces between the files of FilteredRegression. Numbers of a "point" or "detail" refer to
 * docs/filtered-regression.md, which has the derivations.
 */
#ifndef SH_REGRESSION_H
#define SH_REGRESSION_H

#include "information.h"

enum {
    SH_ROW_STEPS = 7,   /* number of steps in which a row changes the state */
    SH_REFIT_STEPS = 16 /* number of steps of a refit after its rows */
};

/* What a step changes. The values may be added up. */
enum {
    SH_NEW_COEFFICIENTS = 1,
    SH_NEW_VARIANCES = 2 /* variances at the point of this tick */
};

/* Positions of the joint, and the signals of the columns there, before the filter. */
typedef struct {
    sh_real theta, q, phi;      /* positions and deformation [rad] */
    sh_real x;                  /* phi / range.phi [1] */
    sh_real power[SH_MAX_N];    /* x^e / e, e of number i [1] */
    sh_real slope[SH_MAX_N];    /* derivative of the power by phi [1/rad] */
    sh_real l[SH_MAX_M];        /* ((set-point - its center) / range.setPoint)^j [1] */
    sh_real phi_set;            /* phi l^j with the highest j [rad] */
    sh_real tau_nominal;        /* torque of the curve rls.eta_0 [N.m] */
    sh_real sigma_nominal;      /* stiffness of the curve rls.eta_0 [N.m/rad] */
    const sh_real *stop;        /* [size: SH_WIDTHS] stop operators of hysteresis [rad] */
    sh_real F[SH_MAX_COLUMNS];  /* signals of the first columns, as far as they have one */
    sh_real dF[SH_MAX_COLUMNS]; /* slopes of F over phi, of the curve of the spring alone */
    sh_filtered filtered;       /* signals after the filters, only at a tick */
} sh_joint_point;

/* Variance of a row, whose inverse is its weight. */
typedef struct {
    sh_real R;        /* [(N.m)2] */
    sh_real lasting;  /* factor in R by errors that last, >= 1 */
    sh_real torque;   /* variance of the filtered y by noise of the torque [(N.m)2] */
    sh_real friction; /* variance by friction of unknown sign [(N.m)2] */
    sh_real share; /* lambda of detail 14: torque over the whole variance of the filtered y, 0..1 */
} sh_row_noise;

/* ---- columns.c --------------------------------------------------------------------------- */

/* Kinds of columns, in the order in which a regression has them. */
enum {
    SH_COLUMN_POWER,         /* torque of the spring: powers of deformation and set-point */
    SH_COLUMN_NOMINAL,       /* the curve rls.eta_0, whose error as a whole is estimated */
    SH_COLUMN_HIGHER_POWER,  /* two more powers of the deformation */
    SH_COLUMN_SET_POWER,     /* one more power of the set-point */
    SH_COLUMN_DEAD_ZONE,     /* backlash */
    SH_COLUMN_KNEE,          /* a slope of the curve that changes at once, at a known place */
    SH_COLUMN_POSSIBLE_KNEE, /* the same, if nobody knows of a knee */
    SH_COLUMN_BIAS, /* bias of the torque, zero of the deformation, uneven friction; behind the spring */
    SH_COLUMN_SIN_Q, /* link encoder that is not centred */
    SH_COLUMN_COS_Q,
    SH_COLUMN_HYSTERESIS, /* the last one with a filter of its own */
    SH_COLUMN_DAMPING,    /* damping of the spring, encoders that are read at different times */
    SH_COLUMN_DELAY,      /* torque that is late or early; from it on, one of each kind */
    SH_COLUMN_REVERSAL, /* friction that reverses late or early; from it on, of the motor: 0 where tau_e is measured */
    SH_COLUMN_SIN_M, /* motor encoder that is not centred */
    SH_COLUMN_COS_M,
    SH_COLUMN_LOAD, /* friction that grows with the torque of the spring */
    SH_COLUMN_DRIVE, /* friction that grows with the torque of the motor; from it on, last in a posterior */
    SH_COLUMN_VISCOUS, /* d */
    SH_COLUMN_COULOMB, /* tau_C */
    SH_COLUMN_INERTIA, /* b: the last column */
    SH_COLUMN_KINDS
};

/* What a column is. */
enum {
    SH_IS_CURVE = 1,   /* a part of the curve of the spring, which may drift */
    SH_IS_POWER = 2,   /* a power of the deformation: its coefficient is an eta */
    SH_IS_EQUATION = 4 /* a term of the equation of motion, not an additional effect */
};

typedef struct {
    int prior;   /* offset of its std deviation in sh_parameters */
    int unit;    /* unit of this std deviation, see columns.c */
    int group;   /* 0: always used */
    unsigned is; /* SH_IS_*, added up */
} sh_column_kind;

extern const sh_column_kind sh_column_kinds[SH_COLUMN_KINDS];

/* Whether the column is one of SH_IS_*, which may be added up. */
static inline int sh_column_is(const sh_column *column, unsigned what)
{
    return (sh_column_kinds[column->kind].is & what) != 0;
}

/* Whether the torque of the spring is measured or modelled, and not computed from the motor's. */
int sh_is_measured(const sh_parameters *p);

/* Whether a nominal curve rls.eta_0 is given. */
int sh_has_nominal_curve(const sh_parameters *p);

/* Power e of phi that belongs to number i: 2 i + 1, or i if the torque is not symmetric. */
int sh_power_of_phi(int symmetric, int i);

/* Number of columns for these parameters. May be larger than SH_MAX_COLUMNS. */
int sh_columns_count(const sh_parameters *p);

/* The columns for these parameters; there must not be more than SH_MAX_COLUMNS. */
void sh_columns_start(sh_columns *columns, const sh_parameters *p);

/* Place of the first column of a kind; -1 if there is none. */
int sh_columns_place(const sh_columns *columns, int kind);

/* Whether column i can be told from the spring after the deformations so far. */
int sh_column_is_distinct(const sh_regression_state *state, const sh_parameters *p, int i);

/* Sets the point of positions [rad], set-point [1] and hysteresis [size: SH_WIDTHS], which is kept. */
void sh_joint_point_at(sh_joint_point *point, const sh_columns *columns, const sh_parameters *p,
                       sh_real theta, sh_real q, sh_real phi, sh_real set_point,
                       const sh_real *stop);

/* Point 6: leaves out the slope of a dead zone that is a gap. Returns the variance of the slope beside a knee, because
 * the place of the knee is not known exactly [(N.m/rad)2].
 */
sh_real sh_columns_judge_knees(const sh_columns *columns, const sh_parameters *p,
                               const sh_real *beta, sh_joint_point *at);

/* Moves the stop operators of hysteresis [size: SH_WIDTHS] by a change of the deformation [rad]. */
void sh_columns_move_stops(sh_real *stop, const sh_parameters *p, sh_real change);

/* y [N.m] of filtered signals. */
sh_real sh_columns_y(const sh_parameters *p, const sh_filtered *f);

/* The row x [size: SH_MAX_ROW] by the mean of the filters: columns, then right-hand sides, of which the last is y
 * less the torque of the nominal curve.
 */
void sh_columns_row(const sh_regression_state *state, const sh_parameters *p, sh_real *x);

/* Detail 14: removes the noise that y contains, too, from the column of the motor's torque in x. The prediction error
 * of y is epsilon [N.m]. Sets the noise that is left, times R. Returns by how much the prediction of y grows [N.m].
 */
sh_real sh_columns_remove_noise(const sh_regression_state *state, const sh_row_noise *noise,
                                sh_real epsilon, sh_real *x, sh_column_noise *left);

/* ---- motion_sign.c: detail 3 ------------------------------------------------------------- */

/* Starts at a position [rad]: the sign is unknown until the position changes. */
void sh_motion_sign_start(sh_motion_sign *motion, sh_real position);

/* Takes the next position [rad].
 *
 * count  smallest change that the encoder can show [rad], >= 0
 * slow   velocity below which the sign counts as unknown, times the sample period [rad], > 0
 */
void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow);

/* ---- signals.c --------------------------------------------------------------------------- */

/* Designs the filters; they start with the next sample. */
void sh_signals_start(sh_signals *signals, sh_history *history, const sh_parameters *p);

/* Lets the estimate wait until the filters have settled. */
void sh_signals_unsettle(sh_signals *signals, sh_history *history);

/* Takes a sample into the history and into all filters. Sets the positions of the joint, also after the filters. */
void sh_signals_take(sh_regression_state *state, const sh_parameters *p, const sh_measurement *z,
                     sh_real set_point, sh_joint_point *at);

/* ---- noise.c ----------------------------------------------------------------------------- */

/* Variance of the noise of theta in the last sample by its fourth difference [rad2], of which it keeps the mean. */
sh_real sh_noise_watch_theta(sh_regression_state *state, const sh_parameters *p);

/* Detail 4: variance of a row, with the noise of theta as the last samples show it. */
sh_row_noise sh_noise_of_row(const sh_regression_state *state, const sh_parameters *p);

/* R times the information in a row that is only rounding: about sigma (point 5) [rad2], about b (detail 7)
 * [(N.m)2].
 */
sh_real sh_noise_of_deformation(const sh_signals *signals);
sh_real sh_noise_of_inertia(const sh_regression_state *state, const sh_parameters *p);

/* Whether the newest row shows that the motor was not at rest at the start (detail 12). */
int sh_noise_contradicts_rest(sh_regression_state *state, const sh_parameters *p,
                              const sh_row_noise *noise);

/* ---- posterior.c: prior and data, which are weighted by the misfit ------------------------ */

void sh_posterior_copy(sh_posterior *to, const sh_posterior *from);

/* Takes a row x: all columns [size: size], then the right-hand sides. The weight of the row is w times the weight of
 * the posterior. Returns 1 / (1 + rho), where rho is the variance of the prediction over the variance of the row.
 */
sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w);

/* Detail 7: adds information [1] about b that is only rounding, and removes as much as possible. The last column,
 * b, does not become less certain than its prior, prior_B > 0.
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real information, sh_real prior_B);

/* Detail 14: the same for the noise of all samples in its column i. */
void sh_posterior_remove_noise(sh_posterior *posterior, sh_real prior_B, int i,
                               const sh_column_noise *noise);

/* Sets beta and per_gain of all columns by the posterior; 0 for columns that are not used. */
void sh_posterior_estimate(sh_regression_state *state, sh_real prior_B);

/* Variances of two combinations [size: count] of the coefficients of the first columns of the data. */
sh_variances sh_posterior_variances(const sh_posterior *posterior, sh_real prior_B,
                                    const sh_real *first, const sh_real *second, int count);

/* ---- misfit.c ---------------------------------------------------------------------------- */

void sh_blocks_start(sh_regression_state *state);

/* Detail 8: takes the last row into the present block. */
void sh_blocks_take(sh_regression_state *state);

static inline int sh_block_is_full(const sh_blocks *blocks)
{
    return blocks->rows >= blocks->length;
}

/* Step 0..3 behind a row. Only if a block is full, one regression in each step takes the mean row of the block. */
void sh_blocks_end(sh_regression_state *state, const sh_parameters *p, int step);

/* Leaves out the samples of the present block: they are not in sequence with the next samples. */
void sh_blocks_interrupt(sh_blocks *blocks);

/* Detail 8: judges the recent blocks by the estimate beta; then sets misfit and variance_factor by all blocks. */
void sh_misfit_judge_recent(sh_regression_state *state, const sh_parameters *p);
void sh_misfit_judge(sh_regression_state *state, const sh_parameters *p);

/* Process noise of a column: an even step sets its sample, and an odd step takes this sample, if there is one. */
void sh_drift_step(sh_refit *refit, sh_information *a, int column, sh_real variance, int step);

/* Step 0..7 of detail 10: lets friction drift for `time` [s]. Every second step takes the sample of the step before.
 * Friction drifts in the data, too, if the blocks contradict each other less with the drift.
 */
void sh_friction_drift(sh_regression_state *state, sh_real time, int step);

/* Details 9 and 11: forgets data that contradict the model, and lets the curve drift for `time` [s]
 * along the last row.
 */
void sh_forget(sh_regression_state *state, const sh_parameters *p, sh_real time);

/* ---- change.c: detail 15 ----------------------------------------------------------------- */

void sh_change_start(sh_regression_state *state);

/* Whether the hypothesis of a change begins anew before the block that it has just taken, and without this block. The
 * squared error of the block, over its variance, is `error` [1].
 */
int sh_change_begins_anew(sh_regression_state *state, sh_real error);

/* Compares the hypotheses by the squares of their errors over the variances in a block: as before, with another spring,
 * and with other friction.
 */
void sh_change_judge(sh_regression_state *state, const sh_parameters *p, sh_real before,
                     sh_real spring, sh_real friction);

/* Step 0..2 behind a row in which no block is taken. Gives friction the variance of its prior, if this hypothesis has
 * just begun. Returns 0 if there is nothing to do.
 */
int sh_change_widens_friction(sh_regression_state *state, int step);

/* The misfit over its usual value [1]. */
sh_real sh_change_misfit(const sh_regression_state *state);

/* Whether the present estimate is in doubt. */
int sh_change_is_likely(const sh_regression_state *state);

/* ---- refit.c: detail 6 ------------------------------------------------------------------- */

/* Starts posterior and refit from the prior. */
void sh_refit_start(sh_regression_state *state, const sh_parameters *p);

/* Starts the refit again. Its trial stays. */
void sh_refit_begin(sh_regression_state *state, const sh_parameters *p);

/* Takes the newest row into the data of all samples. */
void sh_data_take(sh_regression_state *state);

/* Takes the rest of the newest row after sh_data_take, if a refit is running. No row may be read in between. */
void sh_refit_take(sh_regression_state *state);

/* Takes a row of the data of all samples, two where they are short, or does the next step at the end of a refit.
 * Returns SH_NEW_*.
 */
int sh_refit_advance(sh_regression_state *state, const sh_parameters *p);

#endif
