#include <string.h>

#include "information.h"
#include "pair.h"
#include "real_math.h"

/* Least entry of D [1]. An update that would make an entry of D smaller is left out, because 1/D would overflow. */
#define SH_SMALLEST_D SH_FOR(SH_REAL, 1e-300, 1e-37f)
/* Largest factor by which a step may increase a variance [1]. Beyond this factor, D would consist of rounding errors.
 */
#define SH_LARGEST_GROWTH SH_FOR(SH_REAL, 1e12, 1e6f)

/* Returns the index in U at which row i begins. */
static int row_offset(int size, int i)
{
    return i * (size - 1 + SH_RIGHT_SIDES) - i * (i - 1) / 2;
}

sh_real sh_information_sample(const sh_information *a, int i, sh_real *x)
{
    const int size = a->size, row = row_offset(size, i);
    int j;

    for (j = 0; j < i; ++j) {
        x[j] = 0;
    }
    x[i] = 1;
    for (j = i + 1; j < size + SH_RIGHT_SIDES; ++j) {
        x[j] = a->U[row + j - i - 1];
    }
    return a->D[i];
}

sh_last_row sh_information_last(const sh_information *a)
{
    const sh_real *z = a->U + row_offset(a->size, a->size - 1);
    const sh_last_row last = {a->D[a->size - 1], {z[SH_RIGHT_GAIN], z[SH_RIGHT_Y]}};

    return last;
}

void sh_information_set_last(sh_information *a, const sh_last_row *last)
{
    sh_real *z = a->U + row_offset(a->size, a->size - 1);

    a->D[a->size - 1] = last->D;
    z[SH_RIGHT_GAIN] = last->z[SH_RIGHT_GAIN];
    z[SH_RIGHT_Y] = last->z[SH_RIGHT_Y];
}

void sh_information_start(sh_information *a, int size, sh_real precision)
{
    a->size = size;
    a->squares = 0;
    sh_information_restart(a, size, precision);
}

void sh_information_copy(sh_information *to, const sh_information *from)
{
    const int size = from->size;

    to->size = size;
    to->squares = from->squares;
    (void)memcpy(to->D, from->D, sizeof(sh_real) * (size_t)size);
    (void)memcpy(to->U, from->U, sizeof(sh_real) * (size_t)row_offset(size, size));
}

void sh_information_restart(sh_information *a, int count, sh_real precision)
{
    const int rows = count < a->size ? count : a->size;
    int i;

    (void)memset(a->U, 0, sizeof(sh_real) * (size_t)row_offset(a->size, rows));
    for (i = 0; i < rows; ++i) {
        a->D[i] = precision;
    }
}

void sh_information_widen(sh_information *a, int row, sh_real variance)
{
    a->D[row] /= 1 + a->D[row] * variance;
}

/* Error variance v of a sample that some rows have reduced, and 1 / v, so that each row waits for only one addition. */
typedef struct {
    sh_real variance, weight;
} sample_left;

/* Updates an entry of D by the entry x of a sample that the earlier rows have reduced. Returns the gain for the row of
 * U. If D does not change, x becomes 0.
 *
 *     D_i += x_i^2 / v ,   v += x_i^2 / D_i before ,   gain = x_i / (D_i before v) .
 */
static sh_real take_entry(sh_real *D, sh_real *x, sample_left *left)
{
    const sh_real before = *D, square = *x * *x, after = before + left->weight * square;
    sh_real share;

    if (!(sh_fabs(*x) > 0 && after > SH_SMALLEST_D)) {
        *x = 0;
        return 0;
    }
    share = 1 / before;
    *D = after;
    left->variance += square * share;
    left->weight = 1 / left->variance;
    return *x * share * left->weight;
}

/* x -= x_i U_i ,   U_i += gain x */
static void combine(sh_real *restrict row, sh_real *restrict x, int count, sh_real xi, sh_real gain)
{
    int k;

    for (k = 0; k < count; ++k) {
        x[k] -= xi * row[k];
        row[k] += gain * x[k];
    }
}

/* Combines the sample with two rows. Each entry of the sample is read and written only once for both rows. */
static void combine_two(sh_real *restrict first, sh_real *restrict second, sh_real *restrict x,
                        int count, const sh_real *xi, const sh_real *gain)
{
    const sh_real x_0 = xi[0], x_1 = xi[1], gain_0 = gain[0], gain_1 = gain[1];
    int k;

    for (k = 0; k < count; ++k) {
        const sh_real left = x[k] - x_0 * first[k];

        x[k] = left - x_1 * second[k];
        first[k] += gain_0 * left;
        second[k] += gain_1 * x[k];
    }
}

sh_real sh_information_predict(const sh_information *a, sh_real *x, sh_real w)
{
    const int size = a->size;
    const sh_real *row = a->U;
    sample_left left = {1 / w, w};
    int i, k;

    for (i = 0; i < size; ++i) {
        const int count = size - 1 - i + SH_RIGHT_SIDES;
        sh_real D = a->D[i];

        (void)take_entry(&D, &x[i], &left);
        for (k = 0; k < count; ++k) {
            x[i + 1 + k] -= x[i] * row[k];
        }
        row += count;
    }
    return sh_fmin(left.weight, w); /* 1 / (1 / w) may be rounded up */
}

/* Gentleman's update of each row i by the sample x and its weight w, after the rows above have reduced both. */
sh_real sh_information_take_rows(sh_information *a, int first, int end, sh_real *x, sh_real w)
{
    const int size = a->size, begin = first < size ? first : size, rows = end < size ? end : size;
    sh_real *row = a->U + row_offset(size, begin), gain[2];
    sample_left left = {1 / w, w};
    int i = begin;

    while (i < rows) {
        const int count = size - 1 - i + SH_RIGHT_SIDES;

        gain[0] = take_entry(&a->D[i], &x[i], &left);
        if (i + 1 < rows) { /* with the next row */
            sh_real *next = row + count;

            x[i + 1] -= x[i] * row[0];
            row[0] += gain[0] * x[i + 1];
            gain[1] = take_entry(&a->D[i + 1], &x[i + 1], &left);
            if (sh_fabs(x[i]) > 0 || sh_fabs(x[i + 1]) > 0) {
                combine_two(row + 1, next, x + i + 2, count - 1, x + i, gain);
            }
            row = next + count - 1;
            i += 2;
        } else {
            combine(row, x + i + 1, count, x[i], gain[0]);
            row += count;
            i += 1;
        }
    }
    if (rows == size) {
        const sh_real error = x[size + SH_RIGHT_Y];

        a->squares += sh_fmin(left.weight * error * error, SH_LARGE);
    }
    return sh_fmin(left.weight, w); /* 1 / (1 / w) may be rounded up */
}

sh_real sh_information_take(sh_information *a, sh_real *x, sh_real w)
{
    return sh_information_take_rows(a, 0, a->size, x, w);
}

sh_real sh_sum_of_products(const sh_real *a, const sh_real *b, int count)
{
    sh_real sum[4] = {0, 0, 0, 0};
    int k;

    for (k = 0; k < count - 3; k += 4) {
        sum[0] += a[k] * b[k];
        sum[1] += a[k + 1] * b[k + 1];
        sum[2] += a[k + 2] * b[k + 2];
        sum[3] += a[k + 3] * b[k + 3];
    }
    for (; k < count; ++k) {
        sum[0] += a[k] * b[k];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* beta_i = z_i - sum over j > i of U_ij beta_j */
void sh_information_solve(const sh_information *a, const sh_last_row *last, sh_real *beta,
                          sh_real *per_gain)
{
    const int size = a->size;
    const sh_real *row = a->U + row_offset(size, size - 1);
    int i;

    beta[size - 1] = last->z[SH_RIGHT_Y];
    per_gain[size - 1] = last->z[SH_RIGHT_GAIN];
    for (i = size - 2; i >= 0; --i) {
        const int count = size - 1 - i;
        sh_real y, gain;

        row -= count + SH_RIGHT_SIDES;
        sh_scalar_products(row + 1, beta + i + 2, per_gain + i + 2, count - 1, &y, &gain);
        /* The product with the newest entry is subtracted last, so that the other sums need not wait for this entry. */
        beta[i] = row[count + SH_RIGHT_Y] - y - row[0] * beta[i + 1];
        per_gain[i] = row[count + SH_RIGHT_GAIN] - gain - row[0] * per_gain[i + 1];
    }
}

/* a -= a_i row, b -= b_i row */
static void subtract(sh_real *restrict a, sh_real *restrict b, const sh_real *restrict row,
                     int count, sh_real a_i, sh_real b_i)
{
    int k;

    for (k = 0; k < count; ++k) {
        a[k] -= a_i * row[k];
        b[k] -= b_i * row[k];
    }
}

/* With v = U'^-1 c, the variance is the sum of v_i^2 / D_i. In single precision, v_i^2 may overflow if D_i is very
 * large.
 */
sh_variances sh_information_variances(const sh_information *a, sh_real last_D, sh_real *first,
                                      sh_real *second)
{
    const int end = a->size - 1;
    const sh_real *row = a->U;
    sh_variances found = {0, 0};
    int i;

    for (i = 0; i < end; ++i) {
        const int count = end - i;
        const sh_real v = first[i], w = second[i];

        if (sh_fabs(v) > 0 || sh_fabs(w) > 0) {
            const sh_real variance = 1 / a->D[i];

            subtract(first + i + 1, second + i + 1, row, count, v, w);
            found.first += v * variance * v;
            found.second += w * variance * w;
        }
        row += count + SH_RIGHT_SIDES;
    }
    found.first += first[end] / last_D * first[end];
    found.second += second[end] / last_D * second[end];
    return found;
}

sh_real sh_information_squares(const sh_information *a, const sh_real *beta)
{
    const int size = a->size;
    const sh_real *row = a->U;
    sh_real sum = a->squares;
    int i;

    for (i = 0; i < size; ++i) {
        const int count = size - 1 - i;
        const sh_real error =
            row[count + SH_RIGHT_Y] - beta[i] - sh_sum_of_products(row, beta + i + 1, count);

        sum += a->D[i] * error * error;
        row += count + SH_RIGHT_SIDES;
    }
    return sum;
}

void sh_information_forget(sh_information *a, sh_real factor, sh_real least)
{
    int i;

    for (i = 0; i < a->size; ++i) {
        a->D[i] = sh_fmax(a->D[i] * factor, least);
    }
    a->squares *= factor;
}

/* row += D along [1, U_i, z_i], where [1, U_i, z_i] is row i of U from the diagonal on. Returns D along^2. */
static sh_real add_row(sh_real *row, const sh_real *of_U, int count, sh_real D, sh_real along)
{
    const sh_real scaled = D * along;
    int j;

    row[0] += scaled;
    for (j = 0; j < count; ++j) {
        row[1 + j] += scaled * of_U[j];
    }
    return scaled * along;
}

/* -c / (1 + c v' A v); 0 if nothing is known along v, or at an overflow */
static sh_real weight_of_drift(sh_real vAv, sh_real c)
{
    const sh_real variance = sh_fmin(c, SH_LARGEST_GROWTH / vAv);

    return vAv > 0 && isfinite(vAv) ? -variance / (1 + variance * vAv) : 0;
}

/* With the information A = U' D U, the drift is A -= A v v' A c / (1 + c v' A v): an update by a sample of negative
 * weight with the regressor v' A.
 */
sh_real sh_information_drift(sh_information *a, const sh_real *v, sh_real c)
{
    const sh_real *of_U = a->U;
    sh_real row[SH_MAX_ROW] = {0}, vAv = 0, w, share;
    int i;

    for (i = 0; i < a->size; ++i) { /* row = v' U' D [U, U z] */
        const int count = a->size - 1 - i;
        const sh_real along = v[i] + sh_sum_of_products(of_U, v + i + 1, count);

        vAv += add_row(row + i, of_U, count + SH_RIGHT_SIDES, a->D[i], along);
        of_U += count + SH_RIGHT_SIDES;
    }
    w = weight_of_drift(vAv, c);
    share = 1 + w * sh_sum_of_products(row, v, a->size);
    (void)sh_information_take(a, row, w);
    return share;
}

sh_real sh_information_drift_sample(const sh_information *a, int k, sh_real c, sh_real *row)
{
    const int size = a->size;
    const sh_real *of_U = a->U;
    sh_real vAv = 0;
    int i;

    for (i = 0; i < size + SH_RIGHT_SIDES; ++i) {
        row[i] = 0;
    }
    for (i = 0; i < size && i <= k; ++i) { /* v is 1 at k alone */
        const int count = size - 1 - i + SH_RIGHT_SIDES;

        vAv += add_row(row + i, of_U, count, a->D[i], i < k ? of_U[k - i - 1] : 1);
        of_U += count;
    }
    return weight_of_drift(vAv, c);
}
