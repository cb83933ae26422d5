#include "rounding_bias.h"

#include "real_math.h"

void sh_rounding_bias_take_back(sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                sh_real prior_variance)
{
    const sh_real *P_b = sh_least_squares_column(rls, at);
    const sh_real variance = P_b[at];
    const sh_real back = sh_fmin(bias->surplus, 1 / variance - 1 / prior_variance);
    sh_real left;

    if (!(back > 0) || !(variance > 0))
        return;
    /* P^-1 -= back at b, and the sum of squares loses back (1 + b)^2. */
    left = 1 - back * variance;
    if (!(left > 0)) /* too close to nothing for the digits of a number */
        return;
    sh_least_squares_move(rls, back / left * (1 + rls->eta[at]), P_b);
    sh_least_squares_widen_column(rls, back / left, at);
    bias->surplus -= back;
    bias->taken += back;
}

/* What the recursion says of b, prior p = 1 / variance and data together, is not yet all. With the
 * information I that is left the data say I b = s without bias; but s scatters with the variance
 * I + N, where N is what was taken back: the rounding has gone from the mean of s, not from its
 * noise. So the data are worth I^2 / (I + N) and not I. Of b are believed
 *
 *     mean  s I / (I + N) / (p + I^2 / (I + N)) ,   variance  1 / (p + I^2 / (I + N)) ,
 *
 * with s = (I + p) b of the recursion. What is known of the others if b is known stays.
 */
sh_real sh_rounding_bias_belief(const sh_rounding_bias *bias, sh_least_squares *rls, int at,
                                sh_real prior_variance, const sh_real *dF, sh_real *eta)
{
    const sh_real variance = sh_least_squares_variance(rls, dF);
    const sh_real *P_b;
    sh_real of_b, information, share, believed, change, along = 0;
    int i;

    for (i = 0; i < rls->size; ++i)
        eta[i] = rls->eta[i];
    if (!(bias->taken > 0))
        return variance;
    P_b = sh_least_squares_column(rls, at);
    of_b = P_b[at];
    information = sh_fmax(1 / of_b - 1 / prior_variance, 0);
    share = information / (information + bias->taken);
    believed = 1 / (1 / prior_variance + information * share);
    change = (share / of_b * believed - 1) * eta[at] / of_b;
    for (i = 0; i < rls->size; ++i) {
        eta[i] += P_b[i] * change;
        along += P_b[i] * dF[i];
    }
    along /= of_b;
    return variance + along * along * (believed - of_b);
}
