/* Interfaces between the files of FilteredRegression. The equations (F1), (F2) and so on, and the
 * sections, are those of docs/filtered-regression/how-it-works.md, which has the derivations. A constant that is a choice is in the file that uses it, with
 * its unit and its reason; here are those of several files.
 */
#ifndef SH_REGRESSION_H
#define SH_REGRESSION_H

#include "information.h"

/* Number of time constants 1/w after which the start of a filter counts as decayed [1]: 5e-4 of the start are left. */
#define SH_FORGOTTEN ((sh_real)12)
/* More samples than the test of rest takes with the least w T, 1e-4. */
#define SH_LONGEST_REST 200000

enum {
    SH_ROW_JOBS = 7,   /* number of jobs by which a row changes the state */
    SH_BLOCK_JOBS = 4, /* number of jobs of a full block */
    SH_REFIT_JOBS = 15 /* number of jobs of a refit after its rows */
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
    sh_real share;    /* lambda of (F14): torque over the whole variance of the filtered y, 0..1 */
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
    SH_IS_CURVE = 1, /* a part of the curve of the spring, which may drift */
    SH_IS_POWER = 2  /* a power of the deformation: its coefficient is an eta */
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
int sh_column_is_distinct(const sh_columns *columns, const sh_signals *signals,
                          const sh_parameters *p, int i);

/* Sets the point from positions [rad] and set-point [1]. The point keeps the pointer `stop` [size: SH_WIDTHS]. */
void sh_joint_point_at(sh_joint_point *point, const sh_columns *columns, const sh_parameters *p,
                       sh_real theta, sh_real q, sh_real phi, sh_real set_point,
                       const sh_real *stop);

/* Section 1: sets the slope of a dead zone to 0 if the dead zone is a gap. Returns the variance of the slope near a knee
 * [(N.m/rad)2], because the deformation at the knee is not known exactly.
 */
sh_real sh_columns_judge_knees(const sh_columns *columns, const sh_parameters *p,
                               const sh_real *beta, sh_joint_point *at);

/* Moves the stop operators of hysteresis [size: SH_WIDTHS] by a change of the deformation [rad]. */
void sh_columns_move_stops(sh_real *stop, const sh_parameters *p, sh_real change);

/* Returns y [N.m], computed from the filtered signals. */
sh_real sh_columns_y(const sh_parameters *p, const sh_filtered *f);

/* Computes the row x [size: SH_MAX_ROW] from the mean of the filtered signals and the last estimate: first the columns,
 * then the right-hand sides. The last right-hand side is y minus the torque of the nominal curve.
 */
void sh_columns_row(const sh_columns *columns, const sh_mean *mean, const sh_feedback *feedback,
                    const sh_parameters *p, sh_real *x);

/* (F14): removes the noise of the motor torque, which y also contains, from the column of the motor torque in x.
 * The prediction error of y is epsilon [N.m]. Sets `left` to the remaining noise times R. Returns the change of the
 * predicted y [N.m].
 */
sh_real sh_columns_remove_noise(const sh_columns *columns, const sh_real *beta,
                                const sh_row_noise *noise, sh_real epsilon, sh_real *x,
                                sh_column_noise *left);

/* ---- motion_sign.c: (F7) ---------------------------------------------------------------- */

/* Starts the direction of motion at a position [rad]. The direction is unknown until the position changes. */
void sh_motion_sign_start(sh_motion_sign *motion, sh_real position);

/* Updates the direction of motion by the next position [rad].
 *
 * count  smallest change that the encoder can show [rad], >= 0
 * slow   velocity below which the sign counts as unknown, times the sample period [rad], > 0
 */
void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow);

/* ---- gate.c: section 14 ------------------------------------------------------------------ */

/* Sets the limits for the parameters, without knowledge of samples. */
void sh_gate_start(sh_gate *gate, const sh_columns *columns, const sh_parameters *p);

/* Returns 1 if a joint can give a sample. Then the sample is one of the samples from which the next one is predicted.
 *
 * skipped  ticks skipped since the last good sample
 */
int sh_gate_take(sh_gate *gate, const sh_parameters *p, const sh_measurement *z, sh_real set_point,
                 int skipped);

/* ---- signals.c --------------------------------------------------------------------------- */

/* Designs the filters, which start with the next sample. */
void sh_signals_start(sh_signals *signals, const sh_parameters *p);

/* Lets the estimate wait until the filters have settled. */
void sh_signals_unsettle(sh_signals *signals);

/* Updates the history and all filters by a sample. Sets the positions of the joint before and after the filters. The
 * last estimate, beta and feedback, gives the load that causes friction. Returns 1 if the filters started with this
 * sample.
 */
int sh_signals_take(sh_signals *signals, const sh_columns *columns, const sh_real *beta,
                    const sh_feedback *feedback, const sh_parameters *p, const sh_measurement *z,
                    sh_real set_point, sh_joint_point *at);

/* Lets the filters start with the next sample. */
void sh_signals_begin_anew(sh_signals *signals);

/* Sets the history to an earlier one, because the last sample is rejected. */
void sh_signals_restore(sh_signals *signals, const sh_history *history);

/* Sets states of the filters of all signals and `filtered` columns to 0 that are too small to matter. */
void sh_signals_rest(sh_signals *signals, int filtered);

/* Lets a time [s] pass. Returns 1 if the filters have settled. */
static inline int sh_signals_settle(sh_signals *signals, sh_real time)
{
    const sh_real left = signals->history.settling - time;

    signals->history.settling = left > 0 ? left : 0;
    return !(left > 0);
}

/* Returns the noise variance of theta in the last sample [rad2], and updates the mean of this variance. */
sh_real sh_signals_watch_theta(sh_signals *signals, const sh_parameters *p);

/* ---- rest.c: section 13 ------------------------------------------------------------------ */

/* Begins the test whether the motor is at rest at the next sample. It lasts until the filters have forgotten their
 * start.
 */
void sh_rest_start(sh_rest *rest, const sh_filter_design *design);

/* Ends the test. */
void sh_rest_end(sh_rest *rest);

/* Returns 1 until the test ends. */
static inline int sh_rest_is_open(const sh_rest *rest)
{
    return rest->taken <= rest->most;
}

/* Takes a position [rad]. Returns 1 if the positions so far show that the motor was moving at the first sample.
 *
 * count  resolution of the encoder [rad], >= 0
 * rough  noise variance of the position [rad2], >= 0
 */
int sh_rest_take(sh_rest *rest, sh_real theta, sh_real count, sh_real rough);

/* ---- row.c: section 4 -------------------------------------------------------------------- */

/* There is no row yet. */
void sh_row_start(sh_row *row, sh_mean *mean);

/* Adds a sample to the mean: the filtered signals `now`, and the noise variance of theta [rad2]. If the mean is complete,
 * sets the row, empties the mean, and returns 1.
 */
int sh_row_add(sh_row *row, sh_mean *mean, const sh_signals *signals, const sh_columns *columns,
               const sh_feedback *feedback, const sh_parameters *p, const sh_filtered *now,
               sh_real rough);

/* Drops the samples of the mean. */
void sh_mean_empty(sh_mean *mean);

/* Sets the weight 1 / R of a row of `size` columns. Returns 0 if the numbers of the row are too large. */
int sh_row_weigh(sh_row *row, const sh_row_noise *noise, int size);

/* Sets epsilon, and removes the torque noise from the torque column (F14). */
void sh_row_predict(sh_row *row, const sh_columns *columns, const sh_real *beta,
                    const sh_row_noise *noise, sh_column_noise *left);

/* Sets rho from 1 / (1 + rho), the result of sh_posterior_take. */
void sh_row_compare(sh_row *row, sh_real share);

/* Sets epsilon and rho to 0, while the filters settle. */
void sh_row_drop_prediction(sh_row *row);

/* ---- noise.c ----------------------------------------------------------------------------- */

/* Returns the variance of a row by friction whose sign is unknown [(N.m)2]; 0 if the torque is measured. */
sh_real sh_noise_of_friction(const sh_signals *signals, const sh_columns *columns,
                             const sh_posterior *posterior, const sh_real *beta,
                             const sh_parameters *p);

/* (F9) to (F11): returns the variance of a row, of which `friction` is the result of sh_noise_of_friction. The noise of theta
 * is estimated from the last samples.
 */
sh_row_noise sh_noise_of_row(const sh_signals *signals, const sh_feedback *feedback,
                             sh_real friction, const sh_parameters *p);

/* R times the false information in a row by rounding: about sigma (F25) [rad2], about b (F12) [(N.m)2]. */
sh_real sh_noise_of_deformation(const sh_signals *signals);
sh_real sh_noise_of_inertia(const sh_signals *signals, const sh_row *row, const sh_parameters *p);

/* ---- samples.c --------------------------------------------------------------------------- */

/* Initial precision of the data [1]: far below the precision 1 of a prior, but above rounding errors. */
#define SH_LEAST_INFORMATION SH_FOR(SH_REAL, 1e-9, 1e-5f)

/* Starts without information about the coefficients of the columns, of number `size`. */
void sh_samples_start(sh_samples *samples, int size);

/* Counts the noise in the columns of a row of weight w [1/(N.m)2]: `left` times R in the column of the torque, the
 * information N about b [1], and the variance Q of N [1].
 */
void sh_samples_count_noise(sh_samples *samples, const sh_column_noise *left, sh_real w, sh_real N,
                            sh_real Q);

/* Updates the data by a row. Sets `rest`, unless it is a null pointer, to what the rows of the data before
 * `first` leave of the row.
 */
void sh_samples_take(sh_samples *samples, const sh_row *row, int first, sh_sample *rest);

/* Multiplies the weights of all samples by a factor, 0..1. */
void sh_samples_forget(sh_samples *samples, sh_real factor);

/* Adds process noise of a variance along v [size: size]. */
void sh_samples_drift(sh_samples *samples, const sh_real *v, sh_real variance);

/* Process noise of a variance in a column, in two steps: prepares it as a sample, or none if there is no such column;
 * and takes the sample if there is one.
 */
void sh_sample_prepare(sh_sample *sample, const sh_information *a, int column, sh_real variance);
void sh_sample_take(sh_sample *sample, sh_information *a);

/* The same two steps for the data. */
void sh_samples_prepare_drift(sh_samples *samples, int column, sh_real variance);
void sh_samples_take_drift(sh_samples *samples);

/* Replaces the data. The sums that describe the noise of single samples begin at 0. */
void sh_samples_replace(sh_samples *samples, const sh_information *data);

/* ---- posterior.c: prior and data, which are weighted by the misfit ------------------------ */

void sh_posterior_copy(sh_posterior *to, const sh_posterior *from);

/* Updates the posterior by a row x: all columns [size: size], then the right-hand sides. The weight of the row is w
 * times the weight of the posterior. Returns 1 / (1 + rho), rho = variance of prediction / variance of row.
 */
sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w);

/* (F12): counts the information N [1] of a row about b that is only rounding noise, and the variance Q of N [1]. */
void sh_posterior_count_noise(sh_posterior *posterior, sh_real N, sh_real Q);

/* Section 6.1: removes as much of the counted noise as possible. The coefficient b of the last column does not become less
 * certain than its prior, prior_B > 0.
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real prior_B);

/* (F15): removes the noise of all samples from the information about column i of the posterior. */
void sh_posterior_remove_noise(sh_posterior *posterior, sh_real prior_B, int i,
                               const sh_column_noise *noise);

/* Computes beta and per_gain of all columns [size: size] from the posterior; both are 0 for columns that are not used.
 */
void sh_posterior_estimate(const sh_posterior *posterior, int size, sh_real prior_B, sh_real *beta,
                           sh_real *per_gain);

/* Returns the variances of two linear combinations [size: count] of the coefficients of the first columns. */
sh_variances sh_posterior_variances(const sh_posterior *posterior, sh_real prior_B,
                                    const sh_real *first, const sh_real *second, int count);

/* ---- coefficients.c: the estimate -------------------------------------------------------- */

void sh_coefficients_start(sh_coefficients *coefficients, const sh_parameters *p);

/* Computes the coefficients, and the relative errors of the motor, from the posterior. */
void sh_coefficients_solve(sh_coefficients *coefficients, const sh_posterior *posterior,
                           const sh_columns *columns, const sh_parameters *p);

/* Sets the std deviation of the relative error of viscous friction. */
void sh_coefficients_judge_viscous(sh_coefficients *coefficients, const sh_posterior *posterior,
                                   const sh_columns *columns, const sh_parameters *p);

/* ---- point.c ----------------------------------------------------------------------------- */

/* What makes torque and stiffness at a point uncertain beside the coefficients. */
typedef struct {
    sh_real weights;  /* sum of the weights of the samples in the posterior [1/(N.m)2] */
    sh_real rounding; /* V_phi, variance of the filtered phi by rounding (F25) [rad2] */
    sh_real knees;    /* variance of the slope near a knee [(N.m/rad)2] */
} sh_phi_errors;

/* Limit of |phi| / range.phi below which the estimate may be confident, whatever the powers are [1]. */
#define SH_LEAST_LIMIT ((sh_real)2)

/* Returns the |phi| [rad] above which the curve is not known. */
sh_real sh_largest_deformation(const sh_parameters *p);

/* Evaluates torque and stiffness from the coefficients of the spring, the first `count` ones, and the variances of the
 * torque and of the stiffness. Returns the change of the stiffness with the relative gain of the torque [N.m/rad],
 * which may overflow.
 */
sh_real sh_point_evaluate(sh_point *point, const sh_coefficients *coefficients,
                          const sh_parameters *p, const sh_joint_point *at, int count,
                          const sh_variances *variances, const sh_phi_errors *errors);

/* ---- report.c ---------------------------------------------------------------------------- */

/* Sets the outputs that are computed from the coefficients and from the stiffness in the estimate. */
void sh_report_coefficients(const sh_columns *columns, const sh_coefficients *coefficients,
                            const sh_parameters *p, const sh_joint_point *at,
                            sh_estimate *estimate);

/* Returns the reason why the estimate is not confident, SH_DOUBT_*. The variance [(N.m/rad)2] is that of the stiffness
 * if the gain is right.
 */
int sh_report_doubt(const sh_estimate *estimate, const sh_coefficients *coefficients,
                    sh_real variance, const sh_bank *bank, const sh_misfit *misfit,
                    const sh_parameters *p);

/* ---- block.c: section 8 ------------------------------------------------------------------ */

/* Sets the length of a block. */
void sh_block_start(sh_block *block, const sh_signals *signals);

/* Drops the rows of the block, also if the next rows do not follow without a gap. */
void sh_block_empty(sh_block *block);

/* Adds a row of `size` columns. If the block is full, sets its mean row, empties the block, and returns 1; but returns 0
 * if the weight of the mean row would be too large.
 */
int sh_block_take(sh_block *block, const sh_row *row, const sh_signals *signals, int size,
                  const sh_parameters *p, sh_block_mean *mean);

/* ---- misfit.c: sections 8 and 9 ---------------------------------------------------------- */

/* Variance factor above which data are forgotten, and a doubt is reported as a misfit [1]. */
#define SH_CONTRADICTION ((sh_real)1.5)

void sh_misfit_start(sh_misfit *misfit);

/* Updates the usual misfit, and the number of blocks in it, after a block of a duration [s]. */
void sh_misfit_learn(sh_misfit *misfit, sh_real duration);

/* Lets the misfit be larger than before without surprise, after a change of the joint. */
void sh_misfit_begin_anew(sh_misfit *misfit);

/* Returns the mean of a number of blocks, at least 1, after one more value. The value counts as at most `most` times the
 * mean.
 */
sh_real sh_usual(sh_real mean, sh_real value, sh_real most, sh_real blocks);

/* Returns the largest sum of N squared errors over their variances that may be due to chance. */
sh_real sh_largest_by_chance(sh_real N);

/* Computes the misfit and the variance factor of all N blocks with the coefficients beta, of which a number of
 * parameters is estimated. The matrix of the blocks also contains the share `prior` of the prior, 0..1.
 */
void sh_misfit_judge(sh_misfit *misfit, const sh_information *blocks, sh_real prior, sh_real N,
                     const sh_real *beta, int parameters, const sh_parameters *p);

/* Returns 1 if the misfit is far above the usual one. */
int sh_misfit_is_sudden(const sh_misfit *misfit);

/* Returns the factor by which data are forgotten for the blocks since the last call, 0..1: 1 unless the N blocks that
 * count contradict the model.
 */
sh_real sh_misfit_forgetting(sh_misfit *misfit, sh_real N, int parameters, const sh_parameters *p);

/* ---- bank.c: section 12 ------------------------------------------------------------------ */

/* Evidence above which the estimate is in doubt, and evidence above which a change is detected [1]. The second number
 * is multiplied by the square root of the usual squared error. Without a change, one of 3860 runs of 22 s with every
 * misfit reported a change. With 60 in place of 75, one of 1930 runs reported a change.
 */
#define SH_MAY_HAVE_CHANGED ((sh_real)20)
#define SH_HAS_CHANGED ((sh_real)75)

/* What the hypotheses of the bank show. */
typedef enum {
    SH_FOUND_NOTHING,
    SH_FOUND_SPRING,  /* the spring has changed */
    SH_FOUND_FRICTION /* friction has changed */
} sh_finding;

void sh_bank_start(sh_bank *bank, int size);

/* Returns the blocks under the hypothesis that holds now. */
const sh_information *sh_bank_present(const sh_bank *bank);

/* Take the mean row of a block for one hypothesis, in this order. From the coefficients beta of the columns follows by
 * how much the bias may change together with the spring.
 */
void sh_bank_take_for_spring(sh_bank *bank, const sh_columns *columns, const sh_real *beta,
                             const sh_block_mean *mean);
void sh_bank_take_as_before(sh_bank *bank, const sh_block_mean *mean);
void sh_bank_take_for_friction(sh_bank *bank, const sh_block_mean *mean);

/* Counts the last block as `count` blocks. */
void sh_bank_count(sh_bank *bank, sh_real count);

/* Compares the hypotheses by their errors of the last block, after it was counted. The usual misfit is a mean over
 * `judged` blocks.
 */
sh_finding sh_bank_judge(sh_bank *bank, const sh_columns *columns, const sh_real *beta,
                         sh_real judged, sh_real usual_misfit, const sh_parameters *p);

/* Replaces the hypothesis `constant` by what was found. */
void sh_bank_adopt(sh_bank *bank, const sh_columns *columns, const sh_real *beta, sh_finding found);

/* Tells the bank that the estimate contains the adopted change. */
void sh_bank_followed(sh_bank *bank);

/* Returns 1 if the joint may have changed, so that the present estimate is in doubt. */
static inline int sh_bank_doubts(const sh_bank *bank)
{
    return bank->following || bank->evidence > SH_MAY_HAVE_CHANGED;
}

/* Multiplies the weights of all blocks by a factor, 0..1, except for the hypothesis of another spring. */
void sh_bank_forget(sh_bank *bank, sh_real factor);

/* Adds process noise of a variance along v [size: size]. */
void sh_bank_drift(sh_bank *bank, const sh_real *v, sh_real variance);

/* Lets friction drift in two steps, see sh_sample_prepare. */
void sh_bank_prepare_drift(sh_bank *bank, int column, sh_real variance);
void sh_bank_take_drift(sh_bank *bank);

/* Decides by the residuals whether friction drifts, except during a test of other friction. */
void sh_bank_judge_drift(sh_bank *bank);

/* Returns 1 while the test of other friction begins: columns of friction get the variance of their priors once more,
 * as process noise.
 */
int sh_bank_is_widening(const sh_bank *bank, const sh_columns *columns);

/* Makes step 0, 1 or 2 of a row for the next one of these columns. */
void sh_bank_widen_friction(sh_bank *bank, int step);

/* ---- refit.c: section 7 ------------------------------------------------------------------ */

/* No refit has begun, and no group is used. */
void sh_refit_start(sh_refit *refit);

/* Starts a refit of the samples with the same trial. */
void sh_refit_begin(sh_refit *refit, const sh_columns *columns, const sh_signals *signals,
                    const sh_samples *samples, sh_real variance_factor, const sh_parameters *p);

/* Reads one or two rows of the data. Returns 0 if all rows have been read. */
int sh_refit_read(sh_refit *refit, const sh_information *data);

/* Counts the time [s] of a row. */
void sh_refit_wait(sh_refit *refit, sh_real time);

/* Updates the posterior by the member `rest` of the refit, the result of sh_samples_take for a row of `size` columns, if
 * the posterior is open.
 */
void sh_refit_take_rest(sh_refit *refit, int size);

/* After a trial, decides whether the group is used, by N blocks. */
void sh_refit_decide_about_group(sh_refit *refit, const sh_columns *columns, sh_real N);

/* Removes noise from the columns of the posterior. */
void sh_refit_remove_noise(sh_refit *refit, const sh_columns *columns, const sh_column_noise *noise,
                           const sh_parameters *p);

/* Lets the next refit be no trial. */
void sh_refit_drop_trial(sh_refit *refit);

/* Lets the posterior take no more rows. */
void sh_refit_close(sh_refit *refit);

/* Ends a refit and chooses the next trial after N blocks. Returns 1 if there is one. */
int sh_refit_end(sh_refit *refit, const sh_columns *columns, const sh_signals *signals, sh_real N,
                 const sh_parameters *p);

/* Returns 1 if the next refit may begin after N blocks of a duration [s]. */
int sh_refit_is_due(const sh_refit *refit, sh_real N, sh_real duration);

/* ---- schedule.c: section 15, a part of the tick ------------------------------------------ */

/* Starts the first refit, and the posterior from the prior. */
void sh_schedule_start(sh_regression_state *state, const sh_parameters *p);

/* There is a new row, whose jobs begin. */
void sh_schedule_row(sh_schedule *schedule);

/* There is a gap behind the last row. */
void sh_schedule_interrupt(sh_schedule *schedule);

/* Makes the jobs of the last row that belong to this tick. The ticks until the next row share all jobs. Returns
 * SH_NEW_*.
 */
int sh_schedule_advance(sh_regression_state *state, const sh_parameters *p);

#endif
