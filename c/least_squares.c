#include "least_squares.h"

#include <stddef.h>

#include "pair.h"
#include "real_math.h"
#include "ud_factor.h"

/* Largest w rho and largest prediction error that the update accepts. The update changes eta_i by at most sqrt(w P_0)
 * |epsilon| / 2, and divides each D_j by at most 1 + w rho. With this limit, no number overflows, and D stays above 0.
 */
static const sh_real LARGEST = SH_LARGE;

void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0)
{
    int i;

    sh_ud_factor_start(&rls->P, size, P_0);
    for (i = 0; i < SH_MAX_ROWS; ++i) {
        rls->eta[i] = eta_0 != NULL && i < size ? eta_0[i] : 0;
        rls->eta_low[i] = 0;
    }
}

void sh_least_squares_move(sh_least_squares *rls, sh_real c, const sh_real *v)
{
    int i;

    for (i = 0; i < rls->P.size; ++i) {
        const sh_real before = rls->eta[i];
        const sh_real change = c * v[i] + rls->eta_low[i];
        const sh_real after = before + change;
        rls->eta[i] = after;
        rls->eta_low[i] = change - (after - before);
    }
}

/* epsilon = y - F' eta, (14) */
static sh_real prediction_error(const sh_least_squares *rls, const sh_real *F, sh_real y)
{
    sh_real high, low;

    sh_scalar_products(F, rls->eta, rls->eta_low, rls->P.size, &high, &low);
    return y - high - low;
}

/* Stability factor a(k): (27), 1, or constant. */
static sh_real stability_factor(int kind, sh_real factor, sh_real rho)
{
    if (kind == SH_RLS_ENHANCED) {
        return (factor + factor * rho) / (1 + factor * rho);
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

/* Updates the estimate by (25) with the sample that sh_ud_factor_project projected last. */
static int take(sh_least_squares *rls, sh_real w, sh_real rho, sh_real epsilon)
{
    const sh_real *PF;

    if (!(w * rho <= LARGEST) || !(sh_fabs(epsilon) <= LARGEST)) { /* also if not a number */
        return 0;
    }
    PF = sh_ud_factor_update(&rls->P, w);                        /* P -= a K F' P */
    sh_least_squares_move(rls, w * epsilon / (1 + w * rho), PF); /* eta += a K epsilon */
    return 1;
}

int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation)
{
    const sh_real epsilon = prediction_error(rls, F, y);
    const sh_real rho = sh_ud_factor_project(&rls->P, F); /* rho = F' P F, (14) */
    const sh_real w = sample_weight(kind, factor, rho);

    if (!take(rls, w, rho, epsilon)) {
        return 0;
    }
    innovation->epsilon = epsilon;
    innovation->rho = rho;
    innovation->variance = rho / (1 + w * rho);
    innovation->a = stability_factor(kind, factor, rho);
    return 1;
}
