/* Least squares in the information form, without square roots (detail 5). Over samples y = x' beta of weight w, the sum
 * of w x x' is U' D U, with U unit upper triangular. The right-hand sides are U z. A sample is taken in O(size^2), and
 * no parameter needs a prior (Gentleman 1974, Algorithm AS 75, Applied Statistics 23:448-454; Miller 1992, AS 274).
 *
 * D[i] is the information about parameter i if the parameters before are estimated too, and the ones after are exact.
 * Every entry of D must start above 0. Else the entry of a column that other columns make up exactly would be a
 * rounding error. The division by this error would destroy U.
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

/* Copies only the rows that are used. */
void sh_information_copy(sh_information *to, const sh_information *from);

/* Starts again with the first parameters: they get the estimate 0 and the precision. The information about the other
 * parameters, with the first ones unknown, stays.
 *
 * count  number of first parameters, >= 0; all of them if it is larger than size
 */
void sh_information_restart(sh_information *a, int count, sh_real precision);

/* Takes a sample.
 *
 * x  [size: size + SH_RIGHT_SIDES] regressor, then the right-hand sides. It is overwritten: afterwards the
 *    last entry is the prediction error of y before the sample
 * w  weight. If w is negative, a sample of this weight is removed; U' D U must stay positive
 *    definite
 *
 * A row stays as it is if its entry of D would fall below 1e-300, or 1e-37 in single precision. The member `squares`
 * grows by at most SH_LARGE.
 *
 * Returns w / (1 + w rho), where rho = x' (U' D U)^-1 x is from before the sample.
 */
sh_real sh_information_take(sh_information *a, sh_real *x, sh_real w);

/* Adds the rest of a sample after the rows before to the rows first..end - 1. For all rows, one part after the other,
 * this is sh_information_take. Numbers behind the last row count as the number of rows.
 *
 * Returns the weight of the rest in x[end..] for the other rows.
 */
sh_real sh_information_take_rows(sh_information *a, int first, int end, sh_real *x, sh_real w);

/* Returns what sh_information_take would, and changes x in the same way, but does not take the sample. */
sh_real sh_information_predict(const sh_information *a, sh_real *x, sh_real w);

/* Row i of U' D U as a sample: sets x [size: size + SH_RIGHT_SIDES] to row i of [U, U z].
 *
 * i  0..size - 1
 *
 * Returns its weight D[i].
 */
sh_real sh_information_sample(const sh_information *a, int i, sh_real *x);

/* The last row: the information about the last parameter, and its right-hand sides. */
typedef struct {
    sh_real D, z[SH_RIGHT_SIDES];
} sh_last_row;

sh_last_row sh_information_last(const sh_information *a);
void sh_information_set_last(sh_information *a, const sh_last_row *last);

/* The estimate beta of all parameters and its change per_gain with the relative gain of the torque [size: size], with
 * another last row.
 */
void sh_information_solve(const sh_information *a, const sh_last_row *last, sh_real *beta,
                          sh_real *per_gain);

/* Variances c' (U' D U)^-1 c of two combinations c' beta [size: size], which are overwritten. For the last row, D is
 * last_D.
 */
sh_variances sh_information_variances(const sh_information *a, sh_real last_D, sh_real *first,
                                      sh_real *second);

/* a' b [size: count], in four sums that do not wait for each other. */
sh_real sh_sum_of_products(const sh_real *a, const sh_real *b, int count);

/* Weighted sum of squares of y - x' beta over all samples, and of the first precision. */
sh_real sh_information_squares(const sh_information *a, const sh_real *beta);

/* Multiplies the weights of all samples by a forgetting factor, 0..1. No entry of D falls below
 * least.
 */
void sh_information_forget(sh_information *a, sh_real factor, sh_real least);

/* Process noise: the parameters change by a random step along v of variance c, (U' D U)^-1 += c v v'. The
 * variance along v grows by a factor of at most 1e12, or 1e6 in single precision.
 *
 * v  [size: size]
 * c  >= 0
 *
 * Returns the share of the information along v that is left, 0..1.
 */
sh_real sh_information_drift(sh_information *a, const sh_real *v, sh_real c);

/* The same for parameter k alone, without taking it: sets the row [size: size + SH_RIGHT_SIDES] of a sample. Returns
 * its weight, <= 0, with which sh_information_take lets the parameter change.
 */
sh_real sh_information_drift_sample(const sh_information *a, int k, sh_real c, sh_real *row);

#endif
