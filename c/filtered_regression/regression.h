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

/* Flags for the quantities that a step changes. The values may be added up. */
enum {
    SH_NEW_COEFFICIENTS = 1,
    SH_NEW_VARIANCES = 2 /* variances at the point of this tick */
};

/* Positions of the joint, and the signals of the columns at these positions, before the filter. */
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

/* Flags for the properties of a column. */
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

/* Returns 1 if the column has one of the properties `what`: SH_IS_*, which may be added up. */
static inline int sh_column_is(const sh_column *column, unsigned what)
{
    return (sh_column_kinds[column->kind].is & what) != 0;
}

/* Returns 1 if the torque of the spring is measured or modelled, and not computed from the motor torque. */
int sh_is_measured(const sh_parameters *p);

/* Returns 1 if a nominal curve rls.eta_0 is given. */
int sh_has_nominal_curve(const sh_parameters *p);

/* Returns the exponent e of phi in basis function i: 2 i + 1, or i if the torque is not symmetric. */
int sh_power_of_phi(int symmetric, int i);

/* Returns the number of columns for the parameters, which may be larger than SH_MAX_COLUMNS. */
int sh_columns_count(const sh_parameters *p);

/* Lists the columns for the parameters, at most SH_MAX_COLUMNS columns. */
void sh_columns_start(sh_columns *columns, const sh_parameters *p);

/* Returns the index of the first column of a kind; -1 if there is no such column. */
int sh_columns_place(const sh_columns *columns, int kind);

/* Returns 1 if the deformations so far are large enough to distinguish column i from the spring. */
int sh_column_is_distinct(const sh_regression_state *state, const sh_parameters *p, int i);

/* Sets the point from positions [rad] and set-point [1]. The point keeps the pointer `stop` [size: SH_WIDTHS]. */
void sh_joint_point_at(sh_joint_point *point, const sh_columns *columns, const sh_parameters *p,
                       sh_real theta, sh_real q, sh_real phi, sh_real set_point,
                       const sh_real *stop);

/* Point 6: sets the slope of a dead zone to 0 if the dead zone is a gap. Returns the variance of the slope near a knee
 * [(N.m/rad)2], because the deformation at the knee is not known exactly.
 */
sh_real sh_columns_judge_knees(const sh_columns *columns, const sh_parameters *p,
                               const sh_real *beta, sh_joint_point *at);

/* Moves the stop operators of hysteresis [size: SH_WIDTHS] by a change of the deformation [rad]. */
void sh_columns_move_stops(sh_real *stop, const sh_parameters *p, sh_real change);

/* Returns y [N.m], computed from the filtered signals. */
sh_real sh_columns_y(const sh_parameters *p, const sh_filtered *f);

/* Computes the row x [size: SH_MAX_ROW] from the mean of the filtered signals: first the columns, then the right-hand
 * sides. The last right-hand side is y minus the torque of the nominal curve.
 */
void sh_columns_row(const sh_regression_state *state, const sh_parameters *p, sh_real *x);

/* Detail 14: removes the noise of the motor torque, which y also contains, from the column of the motor torque in x.
 * The prediction error of y is epsilon [N.m]. Sets `left` to the remaining noise times R. Returns the change of the
 * predicted y [N.m].
 */
sh_real sh_columns_remove_noise(const sh_regression_state *state, const sh_row_noise *noise,
                                sh_real epsilon, sh_real *x, sh_column_noise *left);

/* ---- motion_sign.c: detail 3 ------------------------------------------------------------- */

/* Starts the direction of motion at a position [rad]. The direction is unknown until the position changes. */
void sh_motion_sign_start(sh_motion_sign *motion, sh_real position);

/* Updates the direction of motion by the next position [rad].
 *
 * count  smallest change that the encoder can show [rad], >= 0
 * slow   velocity below which the sign counts as unknown, times the sample period [rad], > 0
 */
void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow);

/* ---- signals.c --------------------------------------------------------------------------- */

/* Designs the filters, which start with the next sample. */
void sh_signals_start(sh_signals *signals, sh_history *history, const sh_parameters *p);

/* Lets the estimate wait until the filters have settled. */
void sh_signals_unsettle(sh_signals *signals, sh_history *history);

/* Updates the history and all filters by a sample. Sets the positions of the joint before and after the filters. */
void sh_signals_take(sh_regression_state *state, const sh_parameters *p, const sh_measurement *z,
                     sh_real set_point, sh_joint_point *at);

/* ---- noise.c ----------------------------------------------------------------------------- */

/* Returns the noise variance of theta in the last sample [rad2], and updates the mean of this variance. */
sh_real sh_noise_watch_theta(sh_regression_state *state, const sh_parameters *p);

/* Detail 4: returns the variance of a row. The noise of theta is estimated from the last samples. */
sh_row_noise sh_noise_of_row(const sh_regression_state *state, const sh_parameters *p);

/* R times the false information in a row by rounding: about sigma (point 5) [rad2], about b (detail 7) [(N.m)2]. */
sh_real sh_noise_of_deformation(const sh_signals *signals);
sh_real sh_noise_of_inertia(const sh_regression_state *state, const sh_parameters *p);

/* Returns 1 if the newest row shows that the motor was not at rest at the start (detail 12). */
int sh_noise_contradicts_rest(sh_regression_state *state, const sh_parameters *p,
                              const sh_row_noise *noise);

/* ---- posterior.c: prior and data, which are weighted by the misfit ------------------------ */

void sh_posterior_copy(sh_posterior *to, const sh_posterior *from);

/* Updates the posterior by a row x: all columns [size: size], then the right-hand sides. The weight of the row is w
 * times the weight of the posterior. Returns 1 / (1 + rho), rho = variance of prediction / variance of row.
 */
sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w);

/* Detail 7: counts information [1] about b that is only rounding noise, and removes as much of this noise as possible.
 * The coefficient b of the last column does not become less certain than its prior, prior_B > 0.
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real information, sh_real prior_B);

/* Detail 14: removes the noise of all samples from the information about column i of the posterior. */
void sh_posterior_remove_noise(sh_posterior *posterior, sh_real prior_B, int i,
                               const sh_column_noise *noise);

/* Sets beta and per_gain of all columns from the posterior; both are 0 for columns that are not used. */
void sh_posterior_estimate(sh_regression_state *state, sh_real prior_B);

/* Returns the variances of two linear combinations [size: count] of the coefficients of the first columns. */
sh_variances sh_posterior_variances(const sh_posterior *posterior, sh_real prior_B,
                                    const sh_real *first, const sh_real *second, int count);

/* ---- misfit.c ---------------------------------------------------------------------------- */

void sh_blocks_start(sh_regression_state *state);

/* Detail 8: adds the last row to the present block. */
void sh_blocks_take(sh_regression_state *state);

static inline int sh_block_is_full(const sh_blocks *blocks)
{
    return blocks->rows >= blocks->length;
}

/* Makes step 0..3 after a row. If the block is full, each step updates one regression by the mean row of the block. */
void sh_blocks_end(sh_regression_state *state, const sh_parameters *p, int step);

/* Drops the samples of the present block if the next samples do not follow without a gap. */
void sh_blocks_interrupt(sh_blocks *blocks);

/* Detail 8: the two functions compute the misfit of the recent blocks, and misfit and variance_factor of all blocks. */
void sh_misfit_judge_recent(sh_regression_state *state, const sh_parameters *p);
void sh_misfit_judge(sh_regression_state *state, const sh_parameters *p);

/* Adds process noise to a column: an even step prepares a sample, and an odd step takes the sample if there is one. */
void sh_drift_step(sh_refit *refit, sh_information *a, int column, sh_real variance, int step);

/* Makes step 0..7 of detail 10: lets friction drift for `time` [s]. Every second step takes the sample of the previous
 * step. If the blocks contradict each other less with the drift, friction also drifts in the data.
 */
void sh_friction_drift(sh_regression_state *state, sh_real time, int step);

/* Details 9 and 11: forgets data that contradict the model, and lets the curve drift along the last row for `time` [s].
 */
void sh_forget(sh_regression_state *state, const sh_parameters *p, sh_real time);

/* ---- change.c: detail 15 ----------------------------------------------------------------- */

void sh_change_start(sh_regression_state *state);

/* Returns 1 if the hypothesis of a change begins anew before the last block, and without this block. The argument
 * `error` is the squared error of the block, divided by its variance [1].
 */
int sh_change_begins_anew(sh_regression_state *state, sh_real error);

/* Compares three hypotheses by squared errors divided by variances: no change, another spring, other friction. */
void sh_change_judge(sh_regression_state *state, const sh_parameters *p, sh_real before,
                     sh_real spring, sh_real friction);

/* Makes step 0, 1 or 2 after a row that does not complete a block. If the hypothesis of other friction has just begun,
 * the columns of friction get the variance of their priors. Returns 0 if the step changes nothing.
 */
int sh_change_widens_friction(sh_regression_state *state, int step);

/* Returns the misfit divided by the usual misfit [1]. */
sh_real sh_change_misfit(const sh_regression_state *state);

/* Returns 1 if the present estimate is in doubt because of a possible change of the joint. */
int sh_change_is_likely(const sh_regression_state *state);

/* ---- refit.c: detail 6 ------------------------------------------------------------------- */

/* Starts posterior and refit from the prior. */
void sh_refit_start(sh_regression_state *state, const sh_parameters *p);

/* Starts the refit again, with the same trial. */
void sh_refit_begin(sh_regression_state *state, const sh_parameters *p);

/* Updates the data of all samples by the newest row. */
void sh_data_take(sh_regression_state *state);

/* After sh_data_take, updates the posterior of a refit by the remaining part of the newest row. */
void sh_refit_take(sh_regression_state *state);

/* Makes one step of a refit: reads one or two rows of the data, or makes the next end step. Returns SH_NEW_*. */
int sh_refit_advance(sh_regression_state *state, const sh_parameters *p);

#endif
