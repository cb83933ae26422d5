#include "state_variable_filter.h"

#include "constants.h"

/* Far below the resolution of any signal, and far above the numbers that processors compute slowly
 * with, to which a filter at rest would decay.
 */
static const sh_real SMALL = (sh_real)1e-30;

sh_filter_design sh_state_variable_filter_design(sh_real w, sh_real T)
{
    const sh_real wT = w * T, decay = sh_exp(-wT);
    sh_filter_design design;

    design.w = w;
    design.T = T;
    design.lag = 1 / wT;
    design.keep[0] = decay;
    design.keep[1] = decay * wT;
    design.keep[2] = decay * wT * wT / 2;
    return design;
}

void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x, sh_real before)
{
    filter->input = x;
    filter->behind[0] = filter->behind[1] = filter->behind[2] = x - before;
}

/* Advances by T. In the steady state of a ramp, the output of stage i is i + 1 times lag behind the
 * input. Deviations from that decay as in the filter without input.
 */
static void advance(sh_state_variable_filter *filter, const sh_filter_design *design, sh_real lag)
{
    const sh_real *keep = design->keep;
    sh_real *behind = filter->behind;
    const sh_real d0 = behind[0] - lag, d1 = behind[1] - 2 * lag, d2 = behind[2] - 3 * lag;

    behind[0] = lag + keep[0] * d0;
    behind[1] = 2 * lag + keep[0] * d1 + keep[1] * d0;
    behind[2] = 3 * lag + keep[0] * d2 + keep[1] * d1 + keep[2] * d0;
    if (sh_fabs(behind[2]) < SMALL && sh_fabs(behind[1]) < SMALL && sh_fabs(behind[0]) < SMALL) {
        behind[0] = behind[1] = behind[2] = 0;
    }
}

void sh_state_variable_filter_step(sh_state_variable_filter *filter, const sh_filter_design *design,
                                   sh_real x)
{
    advance(filter, design, (x - filter->input) * design->lag);
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

void sh_column_filters_start(sh_column_filters *filters, sh_column_filters *sum, int i, sh_real x,
                             sh_real before)
{
    int k;

    filters->input[i] = x;
    sum->input[i] += x;
    for (k = 0; k < 3; ++k) {
        filters->behind[k][i] = x - before;
        sum->behind[k][i] += x - before;
    }
}

void sh_column_filters_step(sh_column_filters *restrict filters, sh_column_filters *restrict sum,
                            const sh_filter_design *design, const sh_real *restrict x, int count)
{
    const sh_real k0 = design->keep[0], k1 = design->keep[1], k2 = design->keep[2];
    sh_real(*behind)[SH_MAX_COLUMNS] = filters->behind;
    int i;

    for (i = 0; i < count; ++i) { /* as in `advance` */
        const sh_real lag = (x[i] - filters->input[i]) * design->lag, d0 = behind[0][i] - lag,
                      d1 = behind[1][i] - 2 * lag, d2 = behind[2][i] - 3 * lag;
        const sh_real b0 = lag + k0 * d0, b1 = 2 * lag + k0 * d1 + k1 * d0,
                      b2 = 3 * lag + k0 * d2 + k1 * d1 + k2 * d0;

        filters->input[i] = x[i];
        behind[0][i] = b0;
        behind[1][i] = b1;
        behind[2][i] = b2;
        sum->input[i] += x[i];
        sum->behind[0][i] += b0;
        sum->behind[1][i] += b1;
        sum->behind[2][i] += b2;
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
