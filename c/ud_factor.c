/* The arithmetic of P = U D U', and the order of the entries of U in memory, which makes the arithmetic fast.
 *
 * U is stored in panels of SH_PANEL = 4 rows. A panel begins at the diagonal and stores one column after the other; the
 * four entries of a column are neighbours. The ones on the diagonal and the zeros below the diagonal are also stored. U
 * for six parameters:
 *
 *     column   0 1 2 3 4 5
 *     row 0    1 a b d g k   panel 0
 *     row 1    0 1 c e h l
 *     row 2    0 0 1 f i m
 *     row 3    0 0 0 1 j n
 *     row 4            1 o   panel 1
 *     row 5            0 1
 *     -                0 0
 *     -                0 0
 *
 *     memory   1000 a100 bc10 def1 ghij klmn  1000 o100
 *
 * Advantage: the four entries of a column are two pairs (pair.h). Every inner loop computes four neighbours in the same
 * way, without a test for the diagonal. Cost: the zeros and ones need memory (200 entries instead of 153 for 18
 * parameters). The loops below also compute with the stored zeros and ones. For 3 parameters, this additional
 * arithmetic takes much of the time. docs/performance.md has measured times.
 */
#include "ud_factor.h"

#include <string.h>

#include "pair.h"
#include "real_math.h"

enum { TWO_COLUMNS = 2 * SH_PANEL, THREE_COLUMNS = 3 * SH_PANEL }; /* of a panel, in memory */

/* Below this limit, the next updates may let an entry of D underflow. */
static const sh_real FAR_ABOVE_UNDERFLOW = SH_FOR(SH_REAL, 1e-290, 1e-30f);

/* Returns the index of U(i, j) in memory, i <= j. The panel of row i begins at row and column i - i % SH_PANEL. */
static int place(int size, int i, int j)
{
    const int row = i % SH_PANEL, first = i - row;

    return first * size - first * (first - SH_PANEL) / 2 + (j - first) * SH_PANEL + row;
}

/* Returns the distance in memory between the entries of a column in panel 0 and in panel 1. From each panel to the
 * next, this distance decreases by SH_PANEL * SH_PANEL.
 */
static int first_stride(int size)
{
    return (size - SH_PANEL) * SH_PANEL;
}

void sh_ud_factor_start(sh_ud_factor *P, int size, sh_real P_0)
{
    int j;

    (void)memset(P, 0, sizeof *P);
    P->size = size;
    P->least = P_0;
    for (j = 0; j < size; ++j) {
        P->D[j] = P_0;
        P->U[place(size, j, j)] = 1;
    }
}

/* Returns the product of column u of U with F within one panel, as one sum for even and one for odd rows. */
static inline sh_pair panel_product(const sh_real *u, sh_pair F_0, sh_pair F_1)
{
    return sh_pair_add(sh_pair_multiply(sh_pair_load(u), F_0),
                       sh_pair_multiply(sh_pair_load(u + 2), F_1));
}

/* Returns the product of column u of U with F in a panel where rows 2 and 3 of the column are zero. */
static inline sh_pair upper_panel_product(const sh_real *u, sh_pair F_0)
{
    return sh_pair_multiply(sh_pair_load(u), F_0);
}

/* f = U' F for the columns j .. j + 3.
 *
 * diagonal  F in the panel that begins at row j
 */
static void multiply_four(const sh_ud_factor *P, const sh_real *F, int j, const sh_real *diagonal,
                          sh_real *f)
{
    const sh_real *const end = F + j, *u = P->U + place(P->size, 0, j);
    sh_pair sum_0 = sh_pair_both(0), sum_1 = sum_0, sum_2 = sum_0, sum_3 = sum_0;
    sh_pair F_0, F_1;
    int stride = first_stride(P->size);

    for (; F != end; F += SH_PANEL) {
        F_0 = sh_pair_load(F);
        F_1 = sh_pair_load(F + 2);
        sum_0 = sh_pair_add(sum_0, panel_product(u, F_0, F_1));
        sum_1 = sh_pair_add(sum_1, panel_product(u + SH_PANEL, F_0, F_1));
        sum_2 = sh_pair_add(sum_2, panel_product(u + TWO_COLUMNS, F_0, F_1));
        sum_3 = sh_pair_add(sum_3, panel_product(u + THREE_COLUMNS, F_0, F_1));
        u += stride;
        stride -= SH_PANEL * SH_PANEL;
    }
    F_0 = sh_pair_load(diagonal);
    F_1 = sh_pair_load(diagonal + 2);
    sum_0 = sh_pair_add(sum_0, upper_panel_product(u, F_0));
    sum_1 = sh_pair_add(sum_1, upper_panel_product(u + SH_PANEL, F_0));
    sum_2 = sh_pair_add(sum_2, panel_product(u + TWO_COLUMNS, F_0, F_1));
    sum_3 = sh_pair_add(sum_3, panel_product(u + THREE_COLUMNS, F_0, F_1));
    sh_pair_store(f + j, sh_pair_sums(sum_0, sum_1));
    sh_pair_store(f + j + 2, sh_pair_sums(sum_2, sum_3));
}

/* The same for the columns j and j + 1. */
static void multiply_two(const sh_ud_factor *P, const sh_real *F, int j, const sh_real *diagonal,
                         sh_real *f)
{
    const sh_real *const end = F + j, *u = P->U + place(P->size, 0, j);
    sh_pair sum_0 = sh_pair_both(0), sum_1 = sum_0, F_0;
    int stride = first_stride(P->size);

    for (; F != end; F += SH_PANEL) {
        const sh_pair F_1 = sh_pair_load(F + 2);

        F_0 = sh_pair_load(F);
        sum_0 = sh_pair_add(sum_0, panel_product(u, F_0, F_1));
        sum_1 = sh_pair_add(sum_1, panel_product(u + SH_PANEL, F_0, F_1));
        u += stride;
        stride -= SH_PANEL * SH_PANEL;
    }
    F_0 = sh_pair_load(diagonal);
    sum_0 = sh_pair_add(sum_0, upper_panel_product(u, F_0));
    sum_1 = sh_pair_add(sum_1, upper_panel_product(u + SH_PANEL, F_0));
    sh_pair_store(f + j, sh_pair_sums(sum_0, sum_1));
}

/* f = U' F. The last step may compute one column more than U has. This additional column reads the memory of the next
 * panel, and its result is not used.
 */
static void multiply(const sh_ud_factor *P, const sh_real *F, sh_real *f)
{
    const int size = P->size, rest = size % SH_PANEL, full = size - rest;
    const sh_real last[SH_PANEL] = {rest > 0 ? F[full] : 0, rest > 1 ? F[full + 1] : 0,
                                    rest > 2 ? F[full + 2] : 0, 0};
    int j;

    for (j = 0; j + 2 < size; j += SH_PANEL) {
        multiply_four(P, F, j, j < full ? F + j : last, f);
    }
    if (j < size) {
        multiply_two(P, F, j, last, f);
    }
}

sh_real sh_ud_factor_variance(const sh_ud_factor *P, const sh_real *F)
{
    const sh_real *D = P->D;
    sh_real f[SH_MAX_ROWS];
    sh_real even = 0, odd = 0; /* two sums, so that one does not wait for the other */
    const int size = P->size;
    int j;

    multiply(P, F, f);
    for (j = 0; j + 1 < size; j += 2) {
        even += f[j] * (D[j] * f[j]);
        odd += f[j + 1] * (D[j + 1] * f[j + 1]);
    }
    if (j < size) {
        even += f[j] * (D[j] * f[j]);
    }
    return even + odd;
}

/* f = U' F, g = D f, and rho_j = f_0 g_0 + ... + f_{j-1} g_{j-1}, the part of rho = F' P F that
 * belongs to the columns before j.
 */
sh_real sh_ud_factor_project(sh_ud_factor *P, const sh_real *F)
{
    const sh_real *f = P->work.f, *D = P->D;
    sh_real *g = P->work.g, *rho = P->work.rho, before = 0;
    const int size = P->size;
    int j;

    multiply(P, F, P->work.f);
    for (j = 0; j + 1 < size; j += 2) { /* in pairs: the sum is waited for half as often */
        const sh_real g_0 = D[j] * f[j], g_1 = D[j + 1] * f[j + 1];
        const sh_real one = f[j] * g_0, both = one + f[j + 1] * g_1;

        g[j] = g_0;
        g[j + 1] = g_1;
        rho[j] = before;
        rho[j + 1] = before + one;
        before += both;
    }
    if (j < size) {
        g[j] = D[j] * f[j];
        rho[j] = before;
        before += f[j] * g[j];
    }
    rho[size] = before;
    return before;
}

/* Updates the part of column j of U in one panel: u -= s_j p and p += g_j u.
 *
 * s, g  pairs that contain the same number twice
 */
static inline void rotate(sh_real *u, sh_pair s, sh_pair g, sh_pair *p_0, sh_pair *p_1)
{
    const sh_pair u_0 = sh_pair_load(u), u_1 = sh_pair_load(u + 2);

    sh_pair_store(u, sh_pair_subtract(u_0, sh_pair_multiply(s, *p_0)));
    sh_pair_store(u + 2, sh_pair_subtract(u_1, sh_pair_multiply(s, *p_1)));
    *p_0 = sh_pair_add(*p_0, sh_pair_multiply(g, u_0));
    *p_1 = sh_pair_add(*p_1, sh_pair_multiply(g, u_1));
}

/* Clears each column of U whose D_j has underflowed to 0. Such a column has no effect on P, but rounding errors in the
 * column would grow until they overflow.
 */
static void clear_underflowed(sh_ud_factor *P)
{
    int i, j;

    P->least = SH_LARGE;
    for (j = 0; j < P->size; ++j) {
        P->least = sh_fmin(P->least, P->D[j]);
        if (!(P->D[j] > 0)) {
            for (i = 0; i < j; ++i) {
                P->U[place(P->size, i, j)] = 0;
            }
            P->work.f[j] = 0;
        }
    }
}

/* Bierman's update, chapter V, for a sample of weight w. With f, g and rho_j of the projection, and
 * beta_j = 1 + w rho_j, for j = 0, 1, ...
 *
 *     D_j *= beta_j / beta_{j+1} ,
 *     s_j  = w f_j / beta_j ,
 *     U_j -= s_j p_j ,   p_{j+1} = p_j + g_j U_j  (U_j before the change),   p_0 = 0 .
 *
 * At the end p is P F.
 */
const sh_real *sh_ud_factor_update(sh_ud_factor *P, sh_real w)
{
    const int size = P->size;
    sh_real *u = P->U, *g = P->work.g, *s = P->work.f;
    int stride = size * SH_PANEL; /* from the begin of a panel to that of the next */
    int i, j;

    for (j = 0; j < size; ++j) {
        const sh_real beta = 1 + w * P->work.rho[j];

        P->D[j] *= beta / (1 + w * P->work.rho[j + 1]);
        P->work.f[j] = w * P->work.f[j] / beta; /* s_j */
    }
    P->least /= 1 + w * P->work.rho[size]; /* no D_j shrinks by more */
    if (!(P->least > FAR_ABOVE_UNDERFLOW)) {
        clear_underflowed(P);
    }
    /* The loop takes one panel after the other, because an entry of p depends only on the same row of U. Two panels are
     * updated together, because they share the factors of the columns. In the first column of a panel, only the
     * diagonal entry is not zero. In this column, p becomes g_i, and u does not change.
     */
    for (i = 0; i + SH_PANEL < size; i += 2 * SH_PANEL) {
        sh_real *next = u + stride;
        sh_pair p_0 = sh_pair_of(g[i], 0), p_1 = sh_pair_both(0);
        sh_pair p_2 = sh_pair_of(g[i + SH_PANEL], 0), p_3 = p_1;

        for (j = i + 1; j <= i + SH_PANEL; ++j) {
            u += SH_PANEL;
            rotate(u, sh_pair_both(s[j]), sh_pair_both(g[j]), &p_0, &p_1);
        }
        for (; j < size; ++j) {
            const sh_pair s_j = sh_pair_both(s[j]), g_j = sh_pair_both(g[j]);

            u += SH_PANEL;
            next += SH_PANEL;
            rotate(u, s_j, g_j, &p_0, &p_1);
            rotate(next, s_j, g_j, &p_2, &p_3);
        }
        u = next + SH_PANEL;
        stride -= 2 * SH_PANEL * SH_PANEL;
        sh_pair_store(g + i, p_0); /* the columns of the next panels do not need g_i any more */
        sh_pair_store(g + i + 2, p_1);
        sh_pair_store(g + i + 4, p_2);
        sh_pair_store(g + i + 6, p_3);
    }
    if (i < size) {
        sh_pair p_0 = sh_pair_of(g[i], 0), p_1 = sh_pair_both(0);

        for (j = i + 1; j < size; ++j) {
            u += SH_PANEL;
            rotate(u, sh_pair_both(s[j]), sh_pair_both(g[j]), &p_0, &p_1);
        }
        sh_pair_store(g + i, p_0);
        sh_pair_store(g + i + 2, p_1);
    }
    return g;
}
