/* Posterior of the coefficients, computed from the prior and from the data, which are weighted by the misfit. The noise
 * in columns is removed from the information (section 6).
 */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Relative error of the information that is removed as noise [1]: the rounding error repeats with the motion. */
#define SH_REMOVAL_ERROR ((sh_real)0.05)
/* Relative error of the variance of the torque noise [1]: noise.tau is known to 10 %. */
#define SH_TORQUE_NOISE_ERROR ((sh_real)0.2)
/* Least share of the information after the removal of noise [1]. A smaller share would be a rounding error in float. */
#define SH_LEAST_REST ((sh_real)1e-3)

void sh_posterior_copy(sh_posterior *to, const sh_posterior *from)
{
    sh_information_copy(&to->information, &from->information);
    (void)memcpy(to->column, from->column, sizeof to->column);
    to->weight = from->weight;
    to->surplus = from->surplus;
    to->removed = from->removed;
    to->spread = from->spread;
}

sh_real sh_posterior_take(sh_posterior *posterior, const sh_real *x, int size, sh_real w)
{
    const int own = posterior->information.size;
    const sh_real weight = w * posterior->weight;
    sh_real row[SH_MAX_ROW] = {0};
    int i;

    for (i = 0; i < own; ++i) {
        row[i] = x[posterior->column[i]];
    }
    for (i = 0; i < SH_RIGHT_SIDES; ++i) {
        row[own + i] = x[size + i];
    }
    return sh_information_take(&posterior->information, row, weight) / weight;
}

void sh_posterior_count_noise(sh_posterior *posterior, sh_real N, sh_real Q)
{
    posterior->spread += Q * posterior->weight * posterior->weight;
    posterior->surplus += N * posterior->weight;
}

/* D_b -= N removes the information N, which is noise. The right-hand side s = D_b z of y changes by s_y += N / prior.B,
 * because N is biased towards b = -1, which is beta = -1 / prior.B (section 6.1).
 */
void sh_posterior_remove(sh_posterior *posterior, sh_real prior_B)
{
    sh_last_row last = sh_information_last(&posterior->information);
    sh_real N, left;

    N = sh_fmin(posterior->surplus, last.D - 1); /* 1: the prior */
    if (!(N > 0)) {
        return;
    }
    left = sh_fmax(last.D - N, 1); /* D - 1 is rounded where D is larger than 1 / epsilon */
    last.z[SH_RIGHT_GAIN] *= last.D / left;
    last.z[SH_RIGHT_Y] = (last.z[SH_RIGHT_Y] * last.D + N / prior_B) / left;
    last.D = left;
    sh_information_set_last(&posterior->information, &last);
    posterior->surplus -= N;
    posterior->removed += N;
}

/* Returns the last row with the weight of the data about b after the removal of noise: D = 1 + I^2 / (I + N + Q), with
 * I = D_b - 1 and Q = spread + (0.05 N / prior.B)^2 (F13).
 */
static sh_last_row weighed_last(const sh_posterior *posterior, sh_real prior_B)
{
    sh_last_row last = sh_information_last(&posterior->information);
    const sh_real D = last.D, I = sh_fmax(D - 1, 0), N = posterior->removed;

    if (N > 0) {
        const sh_real Q = posterior->spread + sh_square(SH_REMOVAL_ERROR / prior_B * N);
        const sh_real share = I / (I + N + Q);

        last.D = 1 + I * share;
        last.z[SH_RIGHT_GAIN] *= D * share / last.D;
        last.z[SH_RIGHT_Y] *= D * share / last.D;
    }
    return last;
}

/* D = 1 + I + N is the information about the coefficient if all others are estimated, and N is the part by noise. A
 * sample of negative weight reduces the information of the data to I^2 / (I + N + Q), Q = (0.2 G)^2 (F15).
 */
void sh_posterior_remove_noise(sh_posterior *posterior, sh_real prior_B, int i,
                               const sh_column_noise *noise)
{
    const sh_last_row last = weighed_last(posterior, prior_B);
    const sh_real all = noise->information * posterior->weight;
    const sh_information *a = &posterior->information;
    sh_real unit[SH_MAX_COLUMNS] = {0}, row[SH_MAX_ROW] = {0};
    sh_real beta[SH_MAX_COLUMNS] = {0}, per_gain[SH_MAX_COLUMNS] = {0};
    sh_real G = noise->gain * posterior->weight, D, N, I, Q, lost, less;

    unit[i] = row[i] = 1;
    D = 1 / sh_information_variances(a, last.D, unit, beta).first; /* beta is 0 */
    if (!(all > 0) || !(D > 1) || !(D <= SH_LARGE)) {
        return;
    }
    I = sh_fmax(D - 1 - all, SH_LEAST_REST * (D - 1));
    N = D - 1 - I;
    Q = sh_square(SH_TORQUE_NOISE_ERROR * G);
    G *= N / all;
    lost = (N + Q) / (I + N + Q); /* 1 - I / (I + N + Q) */
    less = N + I * lost;
    if (!(less > 0)) {
        return;
    }
    sh_information_solve(a, &last, beta, per_gain);
    row[a->size + SH_RIGHT_GAIN] = (G + lost * (D * per_gain[i] - G)) / less;
    row[a->size + SH_RIGHT_Y] = lost * D * beta[i] / less;
    (void)sh_information_take(&posterior->information, row, -less);
}

void sh_posterior_estimate(const sh_posterior *posterior, int size, sh_real prior_B, sh_real *beta,
                           sh_real *per_gain)
{
    const sh_last_row last = weighed_last(posterior, prior_B);
    sh_real own_beta[SH_MAX_COLUMNS] = {0}, own_gain[SH_MAX_COLUMNS] = {0};
    int i;

    sh_information_solve(&posterior->information, &last, own_beta, own_gain);
    for (i = 0; i < size; ++i) {
        beta[i] = per_gain[i] = 0;
    }
    for (i = 0; i < posterior->information.size; ++i) {
        beta[posterior->column[i]] = own_beta[i];
        per_gain[posterior->column[i]] = own_gain[i];
    }
}

sh_variances sh_posterior_variances(const sh_posterior *posterior, sh_real prior_B,
                                    const sh_real *first, const sh_real *second, int count)
{
    const sh_real last_D = weighed_last(posterior, prior_B).D;
    sh_real own_first[SH_MAX_COLUMNS] = {0}, own_second[SH_MAX_COLUMNS] = {0};
    int i;

    for (i = 0; i < posterior->information.size; ++i) {
        const int of_data = posterior->column[i];

        if (of_data < count) {
            own_first[i] = first[of_data];
            own_second[i] = second[of_data];
        }
    }
    return sh_information_variances(&posterior->information, last_D, own_first, own_second);
}
