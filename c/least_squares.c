#include "least_squares.h"

#include <math.h>
#include <stddef.h>

/* Largest information w rho and prediction error that are taken. The update
 * changes eta_i by at most sqrt(w P_0) |epsilon| / 2 and shrinks no D_j by more
 * than 1 + w rho, so nothing overflows and D stays above 0 (also false: NaN).
 */
static const double LARGEST = 1e150;

/* Column j of U above its diagonal, entries 0..j-1. */
static const double *column(const sh_least_squares *rls, int j)
{
    return rls->U + j * (j - 1) / 2;
}

void sh_least_squares_start(sh_least_squares *rls, int size, const double *eta_0, double P_0)
{
    int j;

    rls->size = size;
    for (j = 0; j < size; ++j) {
        rls->eta[j] = eta_0 != NULL ? eta_0[j] : 0.0;
        rls->eta_low[j] = 0.0;
        rls->D[j] = P_0;
    }
    for (j = 0; j < size * (size - 1) / 2; ++j)
        rls->U[j] = 0.0;
}

/* f = U' F and g = D f; returns rho = F' P F = f' g. */
static double project(const sh_least_squares *rls, const double *F, double *f, double *g)
{
    double rho = 0.0;
    int i, j;

    for (j = 0; j < rls->size; ++j) {
        const double *u = column(rls, j);
        double sum = F[j];
        for (i = 0; i < j; ++i)
            sum += u[i] * F[i];
        f[j] = sum;
        g[j] = rls->D[j] * sum;
        rho += f[j] * g[j];
    }
    return rho;
}

double sh_least_squares_variance(const sh_least_squares *rls, const double *F)
{
    double f[SH_MAX_PARAMETERS], g[SH_MAX_PARAMETERS];

    return project(rls, F, f, g);
}

double sh_least_squares_covariance(const sh_least_squares *rls, int i, int j)
{
    const int last = i > j ? i : j;
    double sum = 0.0;
    int k;

    for (k = last; k < rls->size; ++k) {
        const double u_i = k == i ? 1.0 : column(rls, k)[i];
        const double u_j = k == j ? 1.0 : column(rls, k)[j];
        sum += u_i * rls->D[k] * u_j;
    }
    return sum;
}

/* Stability factor a(k): (27), 1 or as given. */
static double stability_factor(int kind, double factor, double rho)
{
    if (kind == SH_RLS_ENHANCED)
        return (factor + factor * rho) / (1.0 + factor * rho);
    return kind == SH_RLS_CONSTANT_FACTOR ? factor : 1.0;
}

/* Weight of the sample: a / (1 + rho - a rho), which is c for (27) and 1 for (14). */
static double sample_weight(int kind, double factor, double rho)
{
    if (kind == SH_RLS_ENHANCED)
        return factor;
    if (kind == SH_RLS_CONSTANT_FACTOR)
        return factor / (1.0 + (1.0 - factor) * rho);
    return 1.0;
}

/* Takes one sample of which project() gave f, g and rho. */
static int take(sh_least_squares *rls, double w, const double *F, double y, const double *f,
                const double *g, double rho, double *prediction_error)
{
    double PF[SH_MAX_PARAMETERS];
    double epsilon = y, beta = 1.0;
    int i, j;

    for (j = 0; j < rls->size; ++j)
        epsilon -= F[j] * rls->eta[j] + F[j] * rls->eta_low[j];
    if (!(w * rho <= LARGEST) || !(fabs(epsilon) <= LARGEST))
        return 0;

    /* Bierman's rank-one update of U D U' for P - P F (w / (1 + w rho)) F' P.
     * After column j, beta = 1 + w (f_0 g_0 + ... + f_j g_j), PF[0..j] is the
     * product of the leading blocks of P and F.
     */
    for (j = 0; j < rls->size; ++j) {
        double *u = rls->U + j * (j - 1) / 2;
        const double beta_before = beta;
        const double scaled = w * f[j] / beta_before;

        beta += w * f[j] * g[j];
        rls->D[j] *= beta_before / beta;
        PF[j] = g[j];
        for (i = 0; i < j; ++i) {
            const double u_before = u[i];
            u[i] -= scaled * PF[i];
            PF[i] += g[j] * u_before;
        }
    }

    /* eta += a K epsilon with a K = w P F / (1 + w rho), (25) */
    sh_least_squares_move(rls, w * epsilon / beta, PF);
    *prediction_error = epsilon;
    return 1;
}

int sh_least_squares_weigh(sh_least_squares *rls, double w, const double *F, double y,
                           double *epsilon, double *rho)
{
    double f[SH_MAX_PARAMETERS], g[SH_MAX_PARAMETERS];
    const double variance = project(rls, F, f, g);

    if (!take(rls, w, F, y, f, g, variance, epsilon))
        return 0;
    *rho = variance;
    return 1;
}

int sh_least_squares_update(sh_least_squares *rls, int kind, double factor, const double *F,
                            double y, sh_innovation *innovation)
{
    double f[SH_MAX_PARAMETERS], g[SH_MAX_PARAMETERS];
    const double rho = project(rls, F, f, g);

    if (!take(rls, sample_weight(kind, factor, rho), F, y, f, g, rho, &innovation->epsilon))
        return 0;
    innovation->rho = rho;
    innovation->a = stability_factor(kind, factor, rho);
    return 1;
}

void sh_least_squares_prior(sh_least_squares *rls, int i, double variance)
{
    rls->D[i] = variance;
}

void sh_least_squares_widen(sh_least_squares *rls, double c, const double *v)
{
    double rest[SH_MAX_PARAMETERS]; /* v without what the columns so far took */
    int i, j;

    for (j = 0; j < rls->size; ++j)
        rest[j] = v[j];
    for (j = rls->size - 1; j >= 0; --j) {
        double *u = rls->U + j * (j - 1) / 2;
        const double before = rls->D[j];
        const double after = before + c * rest[j] * rest[j];
        const double gain = after > 0.0 ? c * rest[j] / after : 0.0;

        for (i = 0; i < j; ++i) {
            rest[i] -= rest[j] * u[i];
            u[i] += gain * rest[i];
        }
        rls->D[j] = after;
        if (after > 0.0)
            c *= before / after;
    }
}

void sh_least_squares_bound(sh_least_squares *rls, const double *P_max)
{
    int i, j;

    for (i = 0; i < rls->size; ++i) {
        const double variance = sh_least_squares_covariance(rls, i, i);
        double scale;

        if (variance <= P_max[i])
            continue;
        /* S P S with S = 1 but for entry i: row i of U grows by the scale, its column shrinks */
        scale = sqrt(P_max[i] / variance);
        rls->D[i] *= scale * scale;
        for (j = i + 1; j < rls->size; ++j)
            rls->U[j * (j - 1) / 2 + i] *= scale;
        for (j = 0; j < i; ++j)
            rls->U[i * (i - 1) / 2 + j] /= scale;
    }
}

void sh_least_squares_column(const sh_least_squares *rls, int i, double *P_i)
{
    int j, k;

    for (j = 0; j < rls->size; ++j)
        P_i[j] = 0.0;
    /* Columns of U before the i-th have nothing in row i. */
    for (k = i; k < rls->size; ++k) {
        const double *u = column(rls, k);
        const double g = k == i ? rls->D[k] : rls->D[k] * u[i];

        P_i[k] += g;
        for (j = 0; j < k; ++j)
            P_i[j] += u[j] * g;
    }
}

void sh_least_squares_move(sh_least_squares *rls, double c, const double *v)
{
    int j;

    for (j = 0; j < rls->size; ++j) {
        const double before = rls->eta[j];
        const double change = c * v[j] + rls->eta_low[j];
        rls->eta[j] = before + change;
        rls->eta_low[j] = change - (rls->eta[j] - before);
    }
}
