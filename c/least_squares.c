#include "least_squares.h"

#include <stddef.h>
#include <string.h>

#include "pair.h"
#include "real_math.h"

/* The covariance is P = U D U', U unit upper triangular and D diagonal. The matrix P is never computed. A positive
 * entry of D stays positive, so P stays positive definite for all data. Source: Bierman 1977, Factorization Methods for
 * Discrete Sequential Estimation, chapter V.
 *
 * U is stored by columns, without the zeros below the diagonal. A column has pairs of rows (pair.h), so the last pair of
 * an odd column contains its one on the diagonal. The ones of the even columns are not stored. For six parameters:
 *
 *     column   0 1 2 3 4 5
 *     row 0      a b d g k
 *     row 1      1 c e h l
 *     row 2          f i m
 *     row 3          1 j n
 *     row 4              o
 *     row 5              1
 *
 *     memory   a1 bc def1 ghij klmno1
 *
 * The loops take an even column and the next, odd one together, because both need the same pairs of F or P F. If the
 * number of parameters is odd, the last column is alone.
 */

/* Largest w rho and largest prediction error that the update accepts. The update changes eta_i by at most sqrt(w P_0)
 * |epsilon| / 2, and divides each D_j by at most 1 + w rho. With this limit, no number overflows, and D stays above 0.
 */
static const sh_real LARGEST = SH_LARGE;

/* Below this limit, the next updates may let an entry of D underflow. */
static const sh_real FAR_ABOVE_UNDERFLOW = SH_FOR(SH_REAL, 1e-290, 1e-30f);

/* Returns the index of U(0, j) in memory. */
static int first_of_column(int j)
{
    return j * j / 2;
}

static void start_covariance(sh_ud_factor *P, int size, sh_real P_0)
{
    int j;

    (void)memset(P, 0, sizeof *P);
    P->size = size;
    P->least = P_0;
    for (j = 0; j < size; ++j) {
        P->columns[j].D = P_0;
        if (j % 2 == 1) {
            P->U[first_of_column(j) + j] = 1;
        }
    }
}

void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0)
{
    int i;

    start_covariance(&rls->P, size, P_0);
    for (i = 0; i < SH_MAX_ROWS; ++i) {
        rls->eta[i] = eta_0 != NULL && i < size ? eta_0[i] : 0;
        rls->eta_low[i] = 0;
    }
}

/* Sets f_j = U_j' F of a column. Returns f_j D_j f_j. */
static inline sh_real set_f(const sh_ud_factor *P, int j, sh_real f, sh_ud_column *columns)
{
    columns[j].f = f;
    return f * (P->columns[j].D * f);
}

/* Sets f_j of the columns [size: size] to U' F. Returns F' P F, the sum of f_j D_j f_j. */
static inline sh_real project(const sh_ud_factor *P, const sh_real *F, sh_ud_column *columns)
{
    const sh_real *even = P->U;
    const int size = P->size;
    sh_real rho = 0;
    int i, j;

    for (j = 0; j + 1 < size; j += 2) {
        const sh_real *odd = even + j;
        sh_pair of_even = sh_pair_of(F[j], 0);
        sh_pair of_odd = sh_pair_multiply(sh_pair_load(odd + j), sh_pair_load(F + j));

        for (i = 0; i < j; i += 2) {
            const sh_pair F_i = sh_pair_load(F + i);

            of_even = sh_pair_add(of_even, sh_pair_multiply(sh_pair_load(even + i), F_i));
            of_odd = sh_pair_add(of_odd, sh_pair_multiply(sh_pair_load(odd + i), F_i));
        }
        rho += set_f(P, j, sh_pair_sum(of_even), columns);
        rho += set_f(P, j + 1, sh_pair_sum(of_odd), columns);
        even = odd + j + 2;
    }
    if (j < size) {
        sh_pair of_even = sh_pair_of(F[j], 0);

        for (i = 0; i < j; i += 2) {
            of_even =
                sh_pair_add(of_even, sh_pair_multiply(sh_pair_load(even + i), sh_pair_load(F + i)));
        }
        rho += set_f(P, j, sh_pair_sum(of_even), columns);
    }
    return rho;
}

sh_real sh_least_squares_variance(const sh_least_squares *rls, const sh_real *F)
{
    sh_ud_column columns[SH_MAX_ROWS];

    return project(&rls->P, F, columns);
}

/* Rotation of a column of U into P F, see update_covariance. */
typedef struct {
    sh_real s, g;
} rotation;

/* beta of the columns so far, and 1 / beta. */
typedef struct {
    sh_real beta, inverse;
} columns_so_far;

/* Updates D_j and beta, and returns the rotation of column j. */
static inline rotation take_column(sh_ud_factor *P, int j, sh_real w, columns_so_far *columns)
{
    const sh_real f = P->columns[j].f, g = P->columns[j].D * f, wf = w * f;
    const sh_real before = columns->beta, after = before + wf * g;
    const rotation of_column = {wf * columns->inverse, g};

    columns->beta = after;
    columns->inverse = 1 / after;
    P->columns[j].D *= before * columns->inverse;
    return of_column;
}

/* Updates a pair of rows of a column of U: u -= s p. Returns p + g u.
 *
 * s, g  pairs that contain the same number twice
 */
static inline sh_pair rotate(sh_real *u, sh_pair s, sh_pair g, sh_pair p)
{
    const sh_pair before = sh_pair_load(u);

    sh_pair_store(u, sh_pair_subtract(before, sh_pair_multiply(s, p)));
    return sh_pair_add(p, sh_pair_multiply(g, before));
}

/* Clears each column of U whose D_j has underflowed to 0. Such a column has no effect on P, but rounding errors in the
 * column would grow until they overflow.
 */
static void clear_underflowed(sh_ud_factor *P)
{
    int j;

    P->least = SH_LARGE;
    for (j = 0; j < P->size; ++j) {
        P->least = sh_fmin(P->least, P->columns[j].D);
        if (!(P->columns[j].D > 0)) {
            (void)memset(P->U + first_of_column(j), 0, (size_t)j * sizeof P->U[0]);
        }
    }
}

/* P -= P F (w / (1 + w rho)) F' P, so that P^-1 += w F F'. This is Bierman's update for a sample of weight w >= 0. With
 * f = U' F of the projection, for j = 0, 1, ...
 *
 *     g_j = D_j f_j ,   beta_{j+1} = beta_j + w f_j g_j ,   beta_0 = 1 ,
 *     s_j = w f_j / beta_j ,   D_j *= beta_j / beta_{j+1} ,
 *     U_j -= s_j p_j ,   p_{j+1} = p_j + g_j U_j  (U_j before the change),   p_0 = 0 .
 *
 * At the end p is P F, and it is stored in PF.
 */
static inline void update_covariance(sh_ud_factor *P, sh_real w)
{
    sh_real *even = P->U, *p = P->PF;
    const int size = P->size;
    columns_so_far columns = {1, 1};
    int i, j;

    for (j = 0; j + 1 < size; j += 2) {
        sh_real *odd = even + j;
        const rotation of_even = take_column(P, j, w, &columns);
        const rotation of_odd = take_column(P, j + 1, w, &columns);
        const sh_pair s_even = sh_pair_both(of_even.s), g_even = sh_pair_both(of_even.g);
        const sh_pair s_odd = sh_pair_both(of_odd.s), g_odd = sh_pair_both(of_odd.g);

        for (i = 0; i < j; i += 2) {
            const sh_pair p_i = rotate(even + i, s_even, g_even, sh_pair_load(p + i));

            sh_pair_store(p + i, rotate(odd + i, s_odd, g_odd, p_i));
        }
        sh_pair_store(p + j, rotate(odd + j, s_odd, g_odd, sh_pair_of(of_even.g, 0)));
        even = odd + j + 2;
    }
    if (j < size) {
        const rotation of_even = take_column(P, j, w, &columns);
        const sh_pair s_even = sh_pair_both(of_even.s), g_even = sh_pair_both(of_even.g);

        for (i = 0; i < j; i += 2) {
            sh_pair_store(p + i, rotate(even + i, s_even, g_even, sh_pair_load(p + i)));
        }
        p[j] = of_even.g;
    }
    P->least *= columns.inverse; /* no D_j shrinks by more */
    if (!(P->least > FAR_ABOVE_UNDERFLOW)) {
        clear_underflowed(P);
    }
}

void sh_least_squares_move(sh_least_squares *rls, sh_real c, const sh_real *v)
{
    const sh_pair both_c = sh_pair_both(c);
    const int size = rls->P.size;
    int i;

    for (i = 0; i < size; i += 2) {
        const sh_pair v_i = i + 1 < size ? sh_pair_load(v + i) : sh_pair_of(v[i], 0);
        const sh_pair low = sh_pair_load(rls->eta_low + i), before = sh_pair_load(rls->eta + i);
        const sh_pair change = sh_pair_add(sh_pair_multiply(both_c, v_i), low);
        const sh_pair after = sh_pair_add(before, change);

        sh_pair_store(rls->eta + i, after);
        sh_pair_store(rls->eta_low + i, sh_pair_subtract(change, sh_pair_subtract(after, before)));
    }
}

/* epsilon = y - F' eta, (14) */
static sh_real prediction_error(const sh_least_squares *rls, const sh_real *F, sh_real y)
{
    sh_real high, low;

    sh_scalar_products(F, rls->eta, rls->eta_low, rls->P.size, &high, &low);
    return y - high - low;
}

/* Stability factor a(k): (27), 1, or constant.
 *
 * share  1 / (1 + w rho)
 */
static sh_real stability_factor(int kind, sh_real factor, sh_real rho, sh_real share)
{
    if (kind == SH_RLS_ENHANCED) {
        return (factor + factor * rho) * share;
    }
    return kind == SH_RLS_CONSTANT_FACTOR ? factor : 1;
}

/* Weight w of the sample, the left side of (26). */
static sh_real sample_weight(int kind, sh_real factor, sh_real rho)
{
    if (kind == SH_RLS_ENHANCED) {
        return factor;
    }
    if (kind == SH_RLS_CONSTANT_FACTOR) {
        return factor / (1 + (1 - factor) * rho);
    }
    return 1;
}

int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation)
{
    const sh_real rho = project(&rls->P, F, rls->P.columns); /* rho = F' P F, (14) */
    const sh_real epsilon = prediction_error(rls, F, y);
    const sh_real w = sample_weight(kind, factor, rho), share = 1 / (1 + w * rho);

    if (!(w * rho <= LARGEST) || !(sh_fabs(epsilon) <= LARGEST)) { /* also if not a number */
        return 0;
    }
    innovation->epsilon = epsilon;
    innovation->rho = rho;
    innovation->variance = rho * share;
    innovation->a = stability_factor(kind, factor, rho, share);
    update_covariance(&rls->P, w);                              /* P -= a K F' P */
    sh_least_squares_move(rls, w * share * epsilon, rls->P.PF); /* eta += a K epsilon */
    return 1;
}
