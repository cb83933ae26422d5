#include "state_variable_filter.h"

#include "constants.h"

/* Far below the resolution of any signal, and far above the numbers that processors compute slowly
 * with, to which a filter at rest would decay.
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

void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x, sh_real before)
{
    filter->input = x;
    filter->behind[0] = filter->behind[1] = filter->behind[2] = x - before;
}

/* Advances by T, in which the signal rises by so much. In the steady state of a ramp, the output of stage i is
 * (i + 1) / (w T) samples behind the input. Deviations from that decay as in the filter without input.
 */
static void advance(sh_state_variable_filter *filter, const sh_filter_design *design, sh_real rise)
{
    const sh_real *keep = design->keep;
    sh_real *behind = filter->behind;

    behind[2] =
        keep[0] * behind[2] + keep[1] * behind[1] + keep[2] * behind[0] + design->rise[2] * rise;
    behind[1] = keep[0] * behind[1] + keep[1] * behind[0] + design->rise[1] * rise;
    behind[0] = keep[0] * behind[0] + design->rise[0] * rise;
    if (sh_fabs(behind[2]) < SMALL && sh_fabs(behind[1]) < SMALL && sh_fabs(behind[0]) < SMALL) {
        behind[0] = behind[1] = behind[2] = 0;
    }
}

void sh_state_variable_filter_step(sh_state_variable_filter *filter, const sh_filter_design *design,
                                   sh_real x)
{
    advance(filter, design, x - filter->input);
    filter->input = x;
}

void sh_state_variable_filter_step_mean(sh_state_variable_filter *filter,
                                        const sh_filter_design *design, sh_real mean)
{
    const sh_real jump = mean - filter->input;

    filter->behind[0] += jump;
    filter->behind[1] += jump;
    filter->behind[2] += jump;
    advance(filter, design, 0);
    filter->input = mean;
}

void sh_state_variable_filter_add(sh_state_variable_filter *restrict sum,
                                  const sh_state_variable_filter *restrict filter, int count,
                                  sh_real share)
{
    int i;

    for (i = 0; i < count; ++i) {
        sum[i].input += share * filter[i].input;
        sum[i].behind[0] += share * filter[i].behind[0];
        sum[i].behind[1] += share * filter[i].behind[1];
        sum[i].behind[2] += share * filter[i].behind[2];
    }
}

void sh_column_filters_start(sh_column_filters *filters, sh_real *sum, int i, sh_real x,
                             sh_real before)
{
    int k;

    filters->input[i] = x;
    for (k = 0; k < 3; ++k) {
        filters->behind[k][i] = x - before;
    }
    sum[i] += before;
}

void sh_column_filters_step(sh_column_filters *restrict filters, sh_real *restrict sum,
                            const sh_filter_design *design, const sh_real *restrict x, int count)
{
    const sh_real *keep = design->keep, *rise = design->rise;
    const sh_real k0 = keep[0], k1 = keep[1], k2 = keep[2];
    const sh_real r0 = rise[0], r1 = rise[1], r2 = rise[2];
    sh_real(*behind)[SH_MAX_COLUMNS] = filters->behind;
    int i;

    for (i = 0; i < count; ++i) { /* as in `advance` */
        const sh_real u = x[i] - filters->input[i], d0 = behind[0][i], d1 = behind[1][i];
        const sh_real d2 = k0 * behind[2][i] + k1 * d1 + k2 * d0 + r2 * u;

        filters->input[i] = x[i];
        behind[0][i] = k0 * d0 + r0 * u;
        behind[1][i] = k0 * d1 + k1 * d0 + r1 * u;
        behind[2][i] = d2;
        sum[i] += x[i] - d2;
    }
}

void sh_column_filters_rest(sh_column_filters *filters, int count)
{
    sh_real(*behind)[SH_MAX_COLUMNS] = filters->behind;
    int i;

    for (i = 0; i < count; ++i) {
        if (sh_fabs(behind[0][i]) + sh_fabs(behind[1][i]) + sh_fabs(behind[2][i]) < SMALL) {
            behind[0][i] = behind[1][i] = behind[2][i] = 0;
        }
    }
}

sh_real sh_state_variable_filter_output(const sh_state_variable_filter *filter)
{
    return filter->input - filter->behind[2];
}

sh_real sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design)
{
    return design->w * (filter->behind[2] - filter->behind[1]);
}

sh_real sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                        const sh_filter_design *design)
{
    return design->w * design->w * (2 * filter->behind[1] - filter->behind[0] - filter->behind[2]);
}

void sh_state_variable_filter_noise(const sh_filter_design *design, sh_real rows, int K,
                                    sh_real *gain, sh_real *gain_second)
{
    const sh_real last = rows * (sh_real)K + 3 + sh_floor(60 / (design->w * design->T));
    sh_state_variable_filter filter;
    sh_real energy = 0;
    int k;

    sh_state_variable_filter_start(&filter, 0, 0);
    *gain = *gain_second = 0;
    for (k = 0; k < SH_MOST_SAMPLES && (sh_real)k < last; ++k) { /* decayed after 60 / w */
        const int row = k / K;
        const sh_real h = (sh_real)row < rows ? sh_window((sh_real)row, rows) : 0;

        sh_state_variable_filter_step(&filter, design, h);
        energy += sh_square(h);
        *gain += sh_square(sh_state_variable_filter_output(&filter));
        *gain_second += sh_square(sh_state_variable_filter_second(&filter, design));
    }
    *gain /= energy;
    *gain_second /= energy;
}
