#include "least_squares.h"

#include <stddef.h>
#include <string.h>

#include "real_math.h"

/* Largest information w rho and prediction error that are taken. The update
 * changes eta_i by at most sqrt(w P_0) |epsilon| / 2 and shrinks no D_j by more
 * than 1 + w rho, so nothing overflows and D stays above 0 (also false: NaN).
 */
static const sh_real LARGEST = SH_LARGE;

/* Place of entry (i, j) of U, i <= j; the panel begins with row and column i - i % SH_PANEL. */
static int place(int size, int i, int j)
{
    const int row = i % SH_PANEL, first = i - row;

    return first * size - first * (first - SH_PANEL) / 2 + (j - first) * SH_PANEL + row;
}

void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0)
{
    int j;

    memset(rls, 0, sizeof *rls);
    rls->size = size;
    for (j = 0; j < size; ++j) {
        rls->eta[j] = eta_0 != NULL ? eta_0[j] : 0;
        rls->D[j] = P_0;
        rls->U[place(size, j, j)] = 1;
    }
}

/* Copies v [size: size] with zeros behind it, as far as its last panel goes. */
static void set(sh_real *padded, const sh_real *v, int size)
{
    int i;

    for (i = 0; i < size; ++i)
        padded[i] = v[i];
    for (; i % SH_PANEL != 0; ++i)
        padded[i] = 0;
}

/* Adds up one panel's share of column u in U' F: the even and the odd rows by themselves, as they
 * lie side by side.
 */
static void add(const sh_real *u, const sh_real *F, sh_real *sum)
{
    sum[0] += u[0] * F[0] + u[2] * F[2];
    sum[1] += u[1] * F[1] + u[3] * F[3];
}

/* work.f = U' F. SH_PANEL columns share F. Of the columns behind the last one nothing is used: in
 * memory the next panel lies there.
 */
static void project(sh_least_squares *rls, const sh_real *F)
{
    const int size = rls->size;
    sh_real(*sum)[2] = rls->work.pairs;
    sh_real last[SH_PANEL] = {0, 0, 0, 0}; /* F in the last panel, if that has fewer rows */
    int i, j;

    for (i = size - size % SH_PANEL; i < size; ++i)
        last[i % SH_PANEL] = F[i];
    for (j = 0; j < size; j += SH_PANEL) {
        const sh_real *u = rls->U + place(size, 0, j);
        sh_real sum_0[2] = {0, 0}, sum_1[2] = {0, 0}, sum_2[2] = {0, 0}, sum_3[2] = {0, 0};
        int stride = (size - SH_PANEL) * SH_PANEL; /* from a panel to the next */

        for (i = 0; i <= j; i += SH_PANEL) {
            const sh_real *rows = i + SH_PANEL <= size ? F + i : last;
            const sh_real F_i[SH_PANEL] = {rows[0], rows[1], rows[2], rows[3]};
            const sh_real *u_1 = u + SH_PANEL, *u_2 = u_1 + SH_PANEL, *u_3 = u_2 + SH_PANEL;

            add(u, F_i, sum_0);
            add(u_1, F_i, sum_1);
            add(u_2, F_i, sum_2);
            add(u_3, F_i, sum_3);
            u += stride;
            stride -= SH_PANEL * SH_PANEL;
        }
        /* To memory first: gcc 12 transposes what it sees summed up here. */
        sum[j][0] = sum_0[0];
        sum[j][1] = sum_0[1];
        sum[j + 1][0] = sum_1[0];
        sum[j + 1][1] = sum_1[1];
        sum[j + 2][0] = sum_2[0];
        sum[j + 2][1] = sum_2[1];
        sum[j + 3][0] = sum_3[0];
        sum[j + 3][1] = sum_3[1];
    }
    for (j = 0; j < size; ++j)
        rls->work.f[j] = sum[j][0] + sum[j][1];
}

sh_real sh_least_squares_variance(sh_least_squares *rls, const sh_real *F)
{
    const sh_real *f = rls->work.f, *D = rls->D;
    sh_real even = 0, odd = 0; /* they do not wait for each other */
    int j;

    project(rls, F);
    for (j = 0; j + 1 < rls->size; j += 2) {
        even += f[j] * (D[j] * f[j]);
        odd += f[j + 1] * (D[j + 1] * f[j + 1]);
    }
    if (j < rls->size)
        even += f[j] * (D[j] * f[j]);
    return even + odd;
}

sh_real sh_least_squares_covariance(const sh_least_squares *rls, int i, int j)
{
    const int last = i > j ? i : j;
    sh_real sum = 0;
    int k;

    for (k = last; k < rls->size; ++k)
        sum += rls->U[place(rls->size, i, k)] * rls->D[k] * rls->U[place(rls->size, j, k)];
    return sum;
}

/* Stability factor a(k): (27), 1 or as given. */
static sh_real stability_factor(int kind, sh_real factor, sh_real rho)
{
    if (kind == SH_RLS_ENHANCED)
        return (factor + factor * rho) / (1 + factor * rho);
    return kind == SH_RLS_CONSTANT_FACTOR ? factor : 1;
}

/* Weight of the sample: a / (1 + rho - a rho), which is c for (27) and 1 for (14). */
static sh_real sample_weight(int kind, sh_real factor, sh_real rho)
{
    if (kind == SH_RLS_ENHANCED)
        return factor;
    if (kind == SH_RLS_CONSTANT_FACTOR)
        return factor / (1 + (1 - factor) * rho);
    return 1;
}

/* y - F' eta */
static sh_real prediction_error(const sh_least_squares *rls, const sh_real *F, sh_real y)
{
    sh_real high[2] = {0, 0}, low[2] = {0, 0};
    int j;

    for (j = 0; j + 1 < rls->size; j += 2) {
        high[0] += F[j] * rls->eta[j];
        high[1] += F[j + 1] * rls->eta[j + 1];
        low[0] += F[j] * rls->eta_low[j];
        low[1] += F[j + 1] * rls->eta_low[j + 1];
    }
    if (j < rls->size) {
        high[0] += F[j] * rls->eta[j];
        low[0] += F[j] * rls->eta_low[j];
    }
    return y - (high[0] + high[1]) - (low[0] + low[1]);
}

/* Begins a sample: the prediction error, f = U' F, g = D f in the place of F, and rho before each
 * column. Returns the whole rho = F' P F.
 */
static sh_real begin(sh_least_squares *rls, const sh_real *F, sh_real y, sh_real *epsilon)
{
    const sh_real *f = rls->work.f;
    sh_real *g = rls->work.F, *rho = rls->work.rho, before = 0;
    int j;

    project(rls, F);
    *epsilon = prediction_error(rls, F, y);
    for (j = 0; j + 1 < rls->size; j += 2) { /* two at a time wait for each other half as long */
        const sh_real g_0 = rls->D[j] * f[j], g_1 = rls->D[j + 1] * f[j + 1];
        const sh_real one = f[j] * g_0, both = one + f[j + 1] * g_1;

        g[j] = g_0;
        g[j + 1] = g_1;
        rho[j] = before;
        rho[j + 1] = before + one;
        before += both;
    }
    if (j < rls->size) {
        g[j] = rls->D[j] * f[j];
        rho[j] = before;
        before += f[j] * g[j];
    }
    rho[rls->size] = before;
    return before;
}

/* eta += c v */
static void move(sh_real *eta, sh_real *eta_low, sh_real c, const sh_real *v, int size)
{
    int j;

    for (j = 0; j < size; ++j) {
        const sh_real before = eta[j];
        const sh_real change = c * v[j] + eta_low[j];
        const sh_real after = before + change;
        eta[j] = after;
        eta_low[j] = change - (after - before);
    }
}

/* One column u of a panel in the update of take. */
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

/* Takes a sample that was begun. */
static int take(sh_least_squares *rls, sh_real w, sh_real rho, sh_real error)
{
    const int size = rls->size;
    sh_real *u = rls->U, *g = rls->work.F, *s = rls->work.f;
    int i, j;

    if (!(w * rho <= LARGEST) || !(sh_fabs(error) <= LARGEST))
        return 0;

    /* Bierman's rank-one update of U D U' for P - P F (w / (1 + w rho)) F' P. With g = D f and
     * beta_j = 1 + w (f_0 g_0 + ... + f_{j-1} g_{j-1}), D_j shrinks by beta_j / beta_{j+1}, and
     * column j of U by s_j = w f_j / beta_j times the product of the blocks of P and F before it.
     */
    for (j = 0; j < size; ++j) {
        const sh_real beta = 1 + w * rls->work.rho[j];

        rls->D[j] *= beta / (1 + w * rls->work.rho[j + 1]);
        rls->work.f[j] = w * rls->work.f[j] / beta;
    }
    /* Panel after panel, as an entry p of the product needs those of its row alone. In column i of
     * the panel only the one on the diagonal is not zero.
     */
    for (i = 0; i < size; i += SH_PANEL) {
        sh_real p[SH_PANEL] = {g[i], 0, 0, 0};

        u += SH_PANEL;
        for (j = i + 1; j < size; ++j) {
            rotate(u, s[j], g[j], p);
            u += SH_PANEL;
        }
        g[i] = p[0];
        g[i + 1] = p[1];
        g[i + 2] = p[2];
        g[i + 3] = p[3];
    }
    /* eta += a K epsilon with a K = w P F / (1 + w rho), (25) */
    move(rls->eta, rls->eta_low, w * error / (1 + w * rho), g, size);
    return 1;
}

int sh_least_squares_weigh(sh_least_squares *rls, sh_real w, const sh_real *F, sh_real y,
                           sh_real *epsilon, sh_real *rho)
{
    sh_real error;
    const sh_real variance = begin(rls, F, y, &error);

    if (!take(rls, w, variance, error))
        return 0;
    *epsilon = error;
    *rho = variance;
    return 1;
}

int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation)
{
    sh_real error;
    const sh_real rho = begin(rls, F, y, &error);

    if (!take(rls, sample_weight(kind, factor, rho), rho, error))
        return 0;
    innovation->epsilon = error;
    innovation->rho = rho;
    innovation->a = stability_factor(kind, factor, rho);
    return 1;
}

void sh_least_squares_prior(sh_least_squares *rls, int i, sh_real variance)
{
    rls->D[i] = variance;
}

/* Column i of P in `sum`, [size: SH_MAX_ROWS]. */
static void add_up_column(const sh_least_squares *rls, int i, sh_real *sum)
{
    int j, k;

    for (j = 0; j < rls->size; j += SH_PANEL)
        sum[j] = sum[j + 1] = sum[j + 2] = sum[j + 3] = 0;
    /* Columns of U before the i-th have nothing in row i. */
    for (k = i; k < rls->size; ++k) {
        const sh_real g = rls->D[k] * rls->U[place(rls->size, i, k)];
        const sh_real *u = rls->U + place(rls->size, 0, k);
        int stride = (rls->size - SH_PANEL) * SH_PANEL; /* from a panel to the next */

        for (j = 0; j <= k; j += SH_PANEL) {
            sum[j] += u[0] * g;
            sum[j + 1] += u[1] * g;
            sum[j + 2] += u[2] * g;
            sum[j + 3] += u[3] * g;
            u += stride;
            stride -= SH_PANEL * SH_PANEL;
        }
    }
}

const sh_real *sh_least_squares_column(sh_least_squares *rls, int i)
{
    add_up_column(rls, i, rls->work.F);
    return rls->work.F;
}

/* P += c v v' with v in work.f, a combination of the columns of U from `first` on. */
static void widen(sh_least_squares *rls, sh_real c, int first)
{
    sh_real *v = rls->work.f; /* becomes what the columns so far leave of v, with zeros behind */
    int i, j;

    for (j = rls->size - 1; j >= first; --j) {
        const sh_real before = rls->D[j], v_j = v[j];
        const sh_real after = before + c * v_j * v_j;
        const sh_real gain = after > 0 ? c * v_j / after : 0;
        sh_real *u = rls->U + place(rls->size, 0, j);
        int stride = (rls->size - SH_PANEL) * SH_PANEL; /* from a panel to the next */

        for (i = 0; i <= j; i += SH_PANEL) {
            const sh_real v_0 = v[i] - v_j * u[0], v_1 = v[i + 1] - v_j * u[1];
            const sh_real v_2 = v[i + 2] - v_j * u[2], v_3 = v[i + 3] - v_j * u[3];

            v[i] = v_0;
            v[i + 1] = v_1;
            v[i + 2] = v_2;
            v[i + 3] = v_3;
            u[0] += gain * v_0;
            u[1] += gain * v_1;
            u[2] += gain * v_2;
            u[3] += gain * v_3;
            u += stride;
            stride -= SH_PANEL * SH_PANEL;
        }
        rls->D[j] = after;
        if (after > 0)
            c *= before / after;
    }
}

void sh_least_squares_widen(sh_least_squares *rls, sh_real c, const sh_real *v)
{
    set(rls->work.f, v, rls->size);
    widen(rls, c, 0);
}

void sh_least_squares_widen_column(sh_least_squares *rls, sh_real c, int i)
{
    add_up_column(rls, i, rls->work.f);
    widen(rls, c, i);
}

void sh_least_squares_bound(sh_least_squares *rls, int i, sh_real P_max)
{
    const int size = rls->size;
    const sh_real variance = sh_least_squares_covariance(rls, i, i);
    sh_real scale;
    int j;

    if (variance <= P_max)
        return;
    /* S P S with S = 1 but for entry i: row i of U grows by the scale, its column shrinks */
    scale = sh_sqrt(P_max / variance);
    rls->D[i] *= scale * scale;
    for (j = i + 1; j < size; ++j)
        rls->U[place(size, i, j)] *= scale;
    for (j = 0; j < i; ++j)
        rls->U[place(size, j, i)] /= scale;
}

void sh_least_squares_move(sh_least_squares *rls, sh_real c, const sh_real *v)
{
    move(rls->eta, rls->eta_low, c, v, rls->size);
}
