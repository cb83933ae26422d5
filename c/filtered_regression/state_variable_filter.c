#include "real_math.h"
#include "state_variable_filter.h"

/* Largest number of steps of a simulated filter response: the rows, and 60 time constants with the least w T, 1e-4. */
enum { SH_MOST_SAMPLES = 1000000 };

/* Limit far below the resolution of any signal. The state of a filter with a constant input would decay to far smaller
 * numbers, with which processors compute slowly.
 */
static const sh_real SMALL = (sh_real)1e-30;

sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T)
{
    const sh_real wT = w * T, decay = sh_exp(-wT), decayed = 1 - decay;
    sh_filter_design design;

    design.w = w;
    design.T = T;
    design.keep[0] = decay;
    design.keep[1] = decay * wT;
    design.keep[2] = decay * wT * wT / 2;
    design.rise[0] = decayed / wT;
    design.rise[1] = (2 * decayed - design.keep[1]) / wT;
    design.rise[2] = (3 * decayed - 2 * design.keep[1] - design.keep[2]) / wT;
    return design;
}

void sh_filters_start(sh_filters *filters, int i, sh_real x, sh_real before)
{
    int k;

    filters->input[i] = x;
    for (k = 0; k < 3; ++k) {
        filters->behind[k][i] = x - before;
    }
}

void sh_filters_hold(sh_filters *filters, int i, sh_real mean)
{
    const sh_real jump = mean - filters->input[i];
    int k;

    filters->input[i] = mean;
    for (k = 0; k < 3; ++k) {
        filters->behind[k][i] += jump;
    }
}

/* In the steady state of a ramp, the output of stage k is (k + 1) / (w T) samples behind the input. Deviations from the
 * steady state decay in the same way as in a filter without input.
 */
void sh_filters_step(sh_filters *restrict filters, const sh_filter_design *design, int first,
                     const sh_real *restrict x, int count)
{
    const sh_real *keep = design->keep, *rise = design->rise;
    const sh_real k0 = keep[0], k1 = keep[1], k2 = keep[2];
    const sh_real r0 = rise[0], r1 = rise[1], r2 = rise[2];
    sh_real *input = filters->input + first, *behind_0 = filters->behind[0] + first;
    sh_real *behind_1 = filters->behind[1] + first, *behind_2 = filters->behind[2] + first;
    int i;

    for (i = 0; i < count; ++i) {
        const sh_real u = x[i] - input[i], d0 = behind_0[i], d1 = behind_1[i];

        input[i] = x[i];
        behind_0[i] = k0 * d0 + r0 * u;
        behind_1[i] = k0 * d1 + k1 * d0 + r1 * u;
        behind_2[i] = k0 * behind_2[i] + k1 * d1 + k2 * d0 + r2 * u;
    }
}

void sh_filters_rest(sh_filters *filters, int count)
{
    sh_real(*behind)[SH_MAX_FILTERS] = filters->behind;
    int i;

    for (i = 0; i < count; ++i) {
        if (sh_fabs(behind[0][i]) + sh_fabs(behind[1][i]) + sh_fabs(behind[2][i]) < SMALL) {
            behind[0][i] = behind[1][i] = behind[2][i] = 0;
        }
    }
}

void sh_filters_read(const sh_filters *restrict filters, const sh_filter_design *design,
                     sh_filtered *restrict filtered)
{
    const sh_real w = design->w;
    int i;

    /*@ loop unroll SH_FILTERS; */
    for (i = 0; i < SH_FILTERS; ++i) {
        const sh_real d0 = filters->behind[0][i], d1 = filters->behind[1][i];
        const sh_real d2 = filters->behind[2][i];

        filtered->output[i] = filters->input[i] - d2;
        filtered->first[i] = w * (d2 - d1);
        filtered->second[i] = w * w * (2 * d1 - d0 - d2);
    }
}

void sh_state_variable_filter_noise(const sh_filter_design *design, sh_real rows, int K,
                                    sh_real *gain, sh_real *gain_second)
{
    const sh_real last = rows * (sh_real)K + 3 + sh_floor(60 / (design->w * design->T));
    sh_filters one;
    const sh_real w = design->w;
    sh_real energy = 0;
    int k;

    sh_filters_start(&one, 0, 0, 0);
    *gain = *gain_second = 0;
    for (k = 0; k < SH_MOST_SAMPLES && (sh_real)k < last; ++k) { /* decayed after 60 / w */
        const int row = k / K;
        const sh_real h = (sh_real)row < rows ? sh_window((sh_real)row, rows) : 0;

        sh_filters_step(&one, design, 0, &h, 1);
        energy += sh_square(h);
        *gain += sh_square(one.input[0] - one.behind[2][0]);
        *gain_second +=
            sh_square(w * w * (2 * one.behind[1][0] - one.behind[0][0] - one.behind[2][0]));
    }
    *gain /= energy;
    *gain_second /= energy;
}
