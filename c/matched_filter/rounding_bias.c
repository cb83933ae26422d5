#include "rounding_bias.h"

#include "least_squares.h"
#include "real_math.h"
#include "ud_factor.h"

void sh_rounding_bias_remove(sh_rounding_bias *bias, sh_least_squares *rls, int at,
                             sh_real prior_variance)
{
    const sh_real *P_b = sh_ud_factor_column(&rls->P, at);
    const sh_real variance = P_b[at];
    const sh_real back = sh_fmin(bias->surplus, 1 / variance - 1 / prior_variance);
    sh_real left;

    if (!(back > 0) || !(variance > 0))
        return;
    /* P^-1 loses `back` at b, and the sum of squares loses back (1 + b)^2. */
    left = 1 - back * variance;
    if (!(left > 0)) /* too small for the digits of a number */
        return;
    sh_least_squares_move(rls, back / left * (1 + rls->eta[at]), P_b);
    sh_ud_factor_widen_column(&rls->P, back / left, at);
    bias->surplus -= back;
    bias->removed += back;
}

/* The recursion weighs the data for b too much. Let I be the information about b that is left in it
 * after N was removed, and p = 1 / prior variance. The data alone say I b = s, with
 * s = (I + p) b of the recursion. The removal made s unbiased, but it could not remove the noise
 * that rounding added to s: its variance is I + N and not I. So the data have the information
 * I^2 / (I + N), and the estimate of b is
 *
 *     mean  s I / (I + N) / (p + I^2 / (I + N)) ,   variance  1 / (p + I^2 / (I + N)) .
 *
 * The other parameters keep their distribution for a given b.
 */
sh_real sh_rounding_bias_estimate(const sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                  sh_real prior_variance, const sh_real *dF, sh_real *eta)
{
    const sh_real variance = sh_ud_factor_variance(&rls->P, dF);
    const sh_real *P_b;
    sh_real of_b, information, share, corrected, change, along = 0;
    int i;

    for (i = 0; i < rls->P.size; ++i)
        eta[i] = rls->eta[i];
    if (!(bias->removed > 0))
        return variance;
    P_b = sh_ud_factor_column(&rls->P, at);
    of_b = P_b[at];
    information = sh_fmax(1 / of_b - 1 / prior_variance, 0);
    share = information / (information + bias->removed);
    corrected = 1 / (1 / prior_variance + information * share); /* variance of b */
    change = (share / of_b * corrected - 1) * eta[at] / of_b;
    for (i = 0; i < rls->P.size; ++i) {
        eta[i] += P_b[i] * change;
        along += P_b[i] * dF[i];
    }
    along /= of_b;
    return variance + along * along * (corrected - of_b);
}
