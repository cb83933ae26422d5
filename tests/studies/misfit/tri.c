#include "tri.h"

#include <string.h>

#include "real_math.h"

static int offset(int n, int i)
{
    return i * (n - 1 + TRI_SIDES) - i * (i - 1) / 2;
}

sh_real *tri_row(tri *t, int i)
{
    return t->U + offset(t->n, i);
}

void tri_start(tri *t, int n, sh_real precision)
{
    int i;

    t->n = n;
    t->rest = 0;
    memset(t->U, 0, sizeof(sh_real) * (size_t)offset(n, n));
    for (i = 0; i < n; ++i)
        t->D[i] = precision;
}

/* Combines one row of U with a sample. The rest of the sample stays in x, for the next row. Four
 * columns at a time, so that compilers can vectorize the loop.
 */
static void rotate(sh_real *restrict row, sh_real *restrict x, int count, sh_real xi, sh_real s)
{
    int k;

    for (k = 0; k + 4 <= count; k += 4) {
        const sh_real u_0 = row[k], u_1 = row[k + 1], u_2 = row[k + 2], u_3 = row[k + 3];
        const sh_real x_0 = x[k] - xi * u_0, x_1 = x[k + 1] - xi * u_1;
        const sh_real x_2 = x[k + 2] - xi * u_2, x_3 = x[k + 3] - xi * u_3;

        x[k] = x_0;
        x[k + 1] = x_1;
        x[k + 2] = x_2;
        x[k + 3] = x_3;
        row[k] = u_0 + s * x_0;
        row[k + 1] = u_1 + s * x_1;
        row[k + 2] = u_2 + s * x_2;
        row[k + 3] = u_3 + s * x_3;
    }
    for (; k < count; ++k) {
        const sh_real left = x[k] - xi * row[k];

        x[k] = left;
        row[k] += s * left;
    }
}

void tri_take(tri *t, sh_real *x, sh_real w)
{
    const int n = t->n;
    sh_real *row = t->U;
    int i;

    for (i = 0; i < n; ++i) {
        const sh_real xi = x[i], before = t->D[i], after = before + w * xi * xi;
        const int count = n - 1 - i + TRI_SIDES;

        if (sh_fabs(xi) > 0 && after > 0) {
            const sh_real share = 1 / after;

            rotate(row, x + i + 1, count, xi, w * xi * share);
            t->D[i] = after;
            w *= before * share;
            if (!(sh_fabs(w) > 0))
                return;
        }
        row += count;
    }
    t->rest += w * x[n + TRI_SIDES - 1] * x[n + TRI_SIDES - 1];
}

/* Sum of products, in four parts that do not wait for each other. */
static sh_real along(const sh_real *a, const sh_real *b, int count)
{
    sh_real sum[4] = {0, 0, 0, 0};
    int k;

    for (k = 0; k + 4 <= count; k += 4) {
        sum[0] += a[k] * b[k];
        sum[1] += a[k + 1] * b[k + 1];
        sum[2] += a[k + 2] * b[k + 2];
        sum[3] += a[k + 3] * b[k + 3];
    }
    for (; k < count; ++k)
        sum[0] += a[k] * b[k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

void tri_solve(tri *t, int side, sh_real *beta)
{
    const int n = t->n;
    const sh_real *row = tri_row(t, n - 1);
    int i;

    for (i = n - 1; i >= 0; --i) {
        beta[i] = row[n - 1 - i + side] - along(row, beta + i + 1, n - 1 - i);
        row -= n - i + TRI_SIDES; /* the one before is longer by one */
    }
}

void tri_project(tri *t, const sh_real *c, sh_real *v)
{
    const int n = t->n;
    const sh_real *row = t->U;
    int i, k;

    for (i = 0; i < n; ++i)
        v[i] = c[i];
    for (i = 0; i < n; ++i) {
        const sh_real vi = v[i];
        const int count = n - 1 - i;
        sh_real *rest = v + i + 1;

        if (sh_fabs(vi) > 0) {
            for (k = 0; k + 4 <= count; k += 4) {
                const sh_real v_0 = rest[k] - row[k] * vi, v_1 = rest[k + 1] - row[k + 1] * vi;
                const sh_real v_2 = rest[k + 2] - row[k + 2] * vi;
                const sh_real v_3 = rest[k + 3] - row[k + 3] * vi;

                rest[k] = v_0;
                rest[k + 1] = v_1;
                rest[k + 2] = v_2;
                rest[k + 3] = v_3;
            }
            for (; k < count; ++k)
                rest[k] -= row[k] * vi;
        }
        row += count + TRI_SIDES;
    }
}

sh_real tri_squares(tri *t, const sh_real *beta)
{
    const int n = t->n;
    sh_real sum = t->rest;
    int i;

    for (i = 0; i < n; ++i) {
        const sh_real *row = tri_row(t, i);
        const sh_real error =
            row[n - 1 - i + TRI_SIDES - 1] - beta[i] - along(row, beta + i + 1, n - 1 - i);
        sum += t->D[i] * error * error;
    }
    return sum;
}
