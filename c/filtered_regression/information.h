/* Least squares in the information form, without square roots (F16). For samples y = x' beta of weight w, the sum
 * of w x x' is U' D U, with U unit upper triangular. The right-hand sides are U z. The update by a sample takes
 * O(size^2) operations, and no parameter needs a prior (Gentleman 1974, Algorithm AS 75, Applied Statistics 23:448-454;
 * Miller 1992, AS 274).
 *
 * D[i] is the information about parameter i if the parameters before i are also estimated, and the parameters after i
 * are known exactly. Every entry of D must start above 0. Otherwise, the entry of a column that is a linear combination
 * of other columns would be a rounding error. The division by this error would destroy U.
 */
#ifndef SH_INFORMATION_H
#define SH_INFORMATION_H

#include "sigmahat.h"

/* Starts with the estimate 0 of the given precision for each parameter.
 *
 * size       number of parameters, 1..SH_MAX_COLUMNS
 * precision  one over the variance of each parameter, > 0
 */
void sh_information_start(sh_information *a, int size, sh_real precision);

/* Copies the information, but only the entries that `size` parameters need. */
void sh_information_copy(sh_information *to, const sh_information *from);

/* Gives the first parameters the estimate 0 and the precision again. The information about the other parameters stays
 * as if the first parameters were unknown.
 *
 * count  number of first parameters, >= 0; all of them if it is larger than size
 */
void sh_information_restart(sh_information *a, int count, sh_real precision);

/* Adds a variance to one parameter, if the parameters before it are unknown.
 *
 * row       of the first parameter about which there is information
 * variance  >= 0
 */
void sh_information_widen(sh_information *a, int row, sh_real variance);

/* Takes a sample.
 *
 * x  [size: size + SH_RIGHT_SIDES] regressor, then the right-hand sides. The function overwrites x. Afterwards, the
 *    last entry of x is the prediction error of y before the update
 * w  weight. If w is negative, a sample of this weight is removed; U' D U must stay positive definite
 *
 * A row does not change if its entry of D would fall below 1e-300, or 1e-37 in single precision. The member `squares`
 * grows by at most SH_LARGE.
 *
 * Returns w / (1 + w rho), where rho = x' (U' D U)^-1 x is computed before the update.
 */
sh_real sh_information_take(sh_information *a, sh_real *x, sh_real w);

/* Updates only the rows first..end - 1 by a sample that the earlier rows have reduced. Calls for all parts of the rows,
 * in their order, are equal to sh_information_take. A number behind the last row counts as the number of rows.
 *
 * Returns the weight of the reduced sample x[end..] for the rows from `end` on.
 */
sh_real sh_information_take_rows(sh_information *a, int first, int end, sh_real *x, sh_real w);

/* Returns the result of sh_information_take, and changes x in the same way, but does not update the information. */
sh_real sh_information_predict(const sh_information *a, sh_real *x, sh_real w);

/* Sets x [size: size + SH_RIGHT_SIDES] to row i of [U, U z], as a sample for another information matrix.
 *
 * i  0..size - 1
 *
 * Returns D[i], the weight of this sample.
 */
sh_real sh_information_sample(const sh_information *a, int i, sh_real *x);

/* The last row: the information about the last parameter, and its right-hand sides. */
typedef struct {
    sh_real D, z[SH_RIGHT_SIDES];
} sh_last_row;

sh_last_row sh_information_last(const sh_information *a);
void sh_information_set_last(sh_information *a, const sh_last_row *last);

/* Computes the estimate beta of all parameters and its derivative per_gain by the relative gain of the torque [size:
 * size]. The argument `last` replaces the last row.
 */
void sh_information_solve(const sh_information *a, const sh_last_row *last, sh_real *beta,
                          sh_real *per_gain);

/* Returns the variances c' (U' D U)^-1 c of two linear combinations c' beta. The function overwrites both vectors c,
 * `first` and `second` [size: size]. The argument last_D replaces the last entry of D.
 */
sh_variances sh_information_variances(const sh_information *a, sh_real last_D, sh_real *first,
                                      sh_real *second);

/* Returns a' b [size: count], as four independent sums that the processor can compute in parallel. */
sh_real sh_sum_of_products(const sh_real *a, const sh_real *b, int count);

/* Returns the weighted sum of squares of y - x' beta for all samples, including the initial precision. */
sh_real sh_information_squares(const sh_information *a, const sh_real *beta);

/* Multiplies the weights of all samples by a forgetting factor, 0..1. No entry of D falls below least. */
void sh_information_forget(sh_information *a, sh_real factor, sh_real least);

/* Adds process noise: the parameters change by a random step along v of variance c, (U' D U)^-1 += c v v'. The variance
 * along v grows by a factor of at most 1e12, or 1e6 in single precision.
 *
 * v  [size: size]
 * c  >= 0
 *
 * Returns the ratio of the information along v after and before the step, 0..1.
 */
sh_real sh_information_drift(sh_information *a, const sh_real *v, sh_real c);

/* Prepares process noise of variance c for parameter k as a sample: sets the row [size: size + SH_RIGHT_SIDES], and
 * returns the weight of the sample, <= 0. sh_information_take with this sample then adds the process noise.
 */
sh_real sh_information_drift_sample(const sh_information *a, int k, sh_real c, sh_real *row);

#endif
