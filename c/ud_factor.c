/* The arithmetic of P = U D U', and how U lies in memory so that it is fast.
 *
 * U is stored in panels of SH_PANEL = 4 rows. A panel begins at the diagonal and goes on column
 * after column; the four entries of a column are neighbours. The zeros and ones of the triangle are
 * stored too. For six parameters:
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
 * What it gains: every inner loop computes four neighbours in the same way, without a test for the
 * diagonal, so that compilers use vector instructions. For 18 parameters a sample takes 0.8 of the
 * time of the same update on packed columns, for 40 about a half. What it costs: for 3 parameters it
 * takes twice the time; the zeros and ones need memory (200 entries in place of 153 for 18
 * parameters); and below there are loops over panels. More figures are in docs/performance.md.
 */
#include "ud_factor.h"

#include <string.h>

#include "real_math.h"

/* Place of entry (i, j) of U, i <= j, in memory. The panel of row i begins at row and column
 * i - i % SH_PANEL.
 */
static int place(int size, int i, int j)
{
    const int row = i % SH_PANEL, first = i - row;

    return first * size - first * (first - SH_PANEL) / 2 + (j - first) * SH_PANEL + row;
}

/* A column of U is met panel by panel: distance from its entries in panel 0 to those in panel 1.
 * From each panel to the next it is SH_PANEL * SH_PANEL less.
 */
static int first_stride(int size)
{
    return (size - SH_PANEL) * SH_PANEL;
}

void sh_ud_factor_start(sh_ud_factor *P, int size, sh_real P_0)
{
    int j;

    memset(P, 0, sizeof *P);
    P->size = size;
    for (j = 0; j < size; ++j) {
        P->D[j] = P_0;
        P->U[place(size, j, j)] = 1;
    }
}

/* Adds one panel's part of a column u of U to its sum in U' F. Even and odd rows have a sum each,
 * as they are neighbours in memory.
 */
static void add_products(const sh_real *u, const sh_real *F, sh_real *sum)
{
    sum[0] += u[0] * F[0] + u[2] * F[2];
    sum[1] += u[1] * F[1] + u[3] * F[3];
}

/* work.f = U' F, SH_PANEL columns at a time. The last group may have fewer columns; what is
 * computed for the others is not used, as the next panel is in memory there.
 */
static void multiply(sh_ud_factor *P, const sh_real *F)
{
    const int size = P->size;
    sh_real last[SH_PANEL] = {0, 0, 0, 0}; /* F in the last panel, if that has fewer rows */
    int i, j;

    for (i = size - size % SH_PANEL; i < size; ++i)
        last[i % SH_PANEL] = F[i];
    for (j = 0; j < size; j += SH_PANEL) {
        const sh_real *u = P->U + place(size, 0, j);
        sh_real sum_0[2] = {0, 0}, sum_1[2] = {0, 0}, sum_2[2] = {0, 0}, sum_3[2] = {0, 0};
        int stride = first_stride(size);

        for (i = 0; i <= j; i += SH_PANEL) {
            const sh_real *rows = i + SH_PANEL <= size ? F + i : last;
            const sh_real F_i[SH_PANEL] = {rows[0], rows[1], rows[2], rows[3]};
            const sh_real *u_1 = u + SH_PANEL, *u_2 = u_1 + SH_PANEL, *u_3 = u_2 + SH_PANEL;

            add_products(u, F_i, sum_0);
            add_products(u_1, F_i, sum_1);
            add_products(u_2, F_i, sum_2);
            add_products(u_3, F_i, sum_3);
            u += stride;
            stride -= SH_PANEL * SH_PANEL;
        }
        /* Through memory: gcc 12 would transpose vectors to sum them up here. */
        P->work.pairs[j][0] = sum_0[0];
        P->work.pairs[j][1] = sum_0[1];
        P->work.pairs[j + 1][0] = sum_1[0];
        P->work.pairs[j + 1][1] = sum_1[1];
        P->work.pairs[j + 2][0] = sum_2[0];
        P->work.pairs[j + 2][1] = sum_2[1];
        P->work.pairs[j + 3][0] = sum_3[0];
        P->work.pairs[j + 3][1] = sum_3[1];
    }
    for (j = 0; j < size; ++j)
        P->work.f[j] = P->work.pairs[j][0] + P->work.pairs[j][1];
}

sh_real sh_ud_factor_variance(sh_ud_factor *P, const sh_real *F)
{
    const sh_real *f = P->work.f, *D = P->D;
    sh_real even = 0, odd = 0; /* two sums, so that one does not wait for the other */
    int j;

    multiply(P, F);
    for (j = 0; j + 1 < P->size; j += 2) {
        even += f[j] * (D[j] * f[j]);
        odd += f[j + 1] * (D[j + 1] * f[j + 1]);
    }
    if (j < P->size)
        even += f[j] * (D[j] * f[j]);
    return even + odd;
}

/* f = U' F, g = D f, and rho_j = f_0 g_0 + ... + f_{j-1} g_{j-1}, the part of rho = F' P F that
 * belongs to the columns before j.
 */
sh_real sh_ud_factor_project(sh_ud_factor *P, const sh_real *F)
{
    const sh_real *f = P->work.f, *D = P->D;
    sh_real *g = P->work.g, *rho = P->work.rho, before = 0;
    int j;

    multiply(P, F);
    for (j = 0; j + 1 < P->size; j += 2) { /* in pairs: the sum is waited for half as often */
        const sh_real g_0 = D[j] * f[j], g_1 = D[j + 1] * f[j + 1];
        const sh_real one = f[j] * g_0, both = one + f[j + 1] * g_1;

        g[j] = g_0;
        g[j + 1] = g_1;
        rho[j] = before;
        rho[j + 1] = before + one;
        before += both;
    }
    if (j < P->size) {
        g[j] = D[j] * f[j];
        rho[j] = before;
        before += f[j] * g[j];
    }
    rho[P->size] = before;
    return before;
}

/* One panel's part of column j of U in the update: u -= s_j p and p += g_j u. */
static void rotate(sh_real *u, sh_real s, sh_real g, sh_real *p)
{
    const sh_real u_0 = u[0], u_1 = u[1], u_2 = u[2], u_3 = u[3];

    u[0] = u_0 - s * p[0];
    u[1] = u_1 - s * p[1];
    u[2] = u_2 - s * p[2];
    u[3] = u_3 - s * p[3];
    p[0] += g * u_0;
    p[1] += g * u_1;
    p[2] += g * u_2;
    p[3] += g * u_3;
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
    int i, j;

    for (j = 0; j < size; ++j) {
        const sh_real beta = 1 + w * P->work.rho[j];

        P->D[j] *= beta / (1 + w * P->work.rho[j + 1]);
        P->work.f[j] = w * P->work.f[j] / beta; /* s_j */
    }
    /* Panel after panel, as an entry of p depends on its own row of U alone. In the first column of
     * a panel only the one on the diagonal is not zero: there p becomes g_i, and u does not change.
     */
    for (i = 0; i < size; i += SH_PANEL) {
        sh_real p[SH_PANEL] = {g[i], 0, 0, 0};

        u += SH_PANEL;
        for (j = i + 1; j < size; ++j) {
            rotate(u, s[j], g[j], p);
            u += SH_PANEL;
        }
        g[i] = p[0]; /* the columns of the next panels do not need g_i any more */
        g[i + 1] = p[1];
        g[i + 2] = p[2];
        g[i + 3] = p[3];
    }
    return g;
}
