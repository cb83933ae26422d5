#include "state_variable_filter.h"

#include "real_math.h"

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

void sh_state_variable_filter_start(sh_state_variable_filter *filter, sh_real x)
{
    filter->input = x;
    filter->stage[0] = x;
    filter->stage[1] = x;
    filter->stage[2] = x;
}

void sh_state_variable_filter_begin(sh_state_variable_filter *filter, sh_real x)
{
    sh_state_variable_filter_start(filter, 0);
    filter->input = x;
}

/* Advances by T. In the steady state of a ramp, stage i runs behind it by i + 1 times lag;
 * deviations from that die out as in the unforced filter.
 */
static void advance(sh_state_variable_filter *filter, const sh_filter_design *design, sh_real from,
                    sh_real to, sh_real lag)
{
    const sh_real *keep = design->keep;
    const sh_real d0 = filter->stage[0] - (from - lag);
    const sh_real d1 = filter->stage[1] - (from - 2 * lag);
    const sh_real d2 = filter->stage[2] - (from - 3 * lag);

    filter->stage[0] = to - lag + keep[0] * d0;
    filter->stage[1] = to - 2 * lag + keep[0] * d1 + keep[1] * d0;
    filter->stage[2] = to - 3 * lag + keep[0] * d2 + keep[1] * d1 + keep[2] * d0;
}

void sh_state_variable_filter_step(sh_state_variable_filter *filter,
                                   const sh_filter_design *design, sh_real x)
{
    advance(filter, design, filter->input, x, (x - filter->input) * design->lag);
    filter->input = x;
}

void sh_state_variable_filter_step_mean(sh_state_variable_filter *filter,
                                        const sh_filter_design *design, sh_real mean)
{
    advance(filter, design, mean, mean, 0);
}

sh_real sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design)
{
    return design->w * (filter->stage[1] - filter->stage[2]);
}

sh_real sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                        const sh_filter_design *design)
{
    return design->w * design->w *
           (filter->stage[0] - 2 * filter->stage[1] + filter->stage[2]);
}

sh_real sh_state_variable_filter_noise(const sh_filter_design *design)
{
    /* Sum of squares of the response to one sample; it has died out after 60 time constants. */
    const sh_real samples = 2 + 60 / (design->w * design->T);
    sh_state_variable_filter filter;
    sh_real k, sum = 0;

    sh_state_variable_filter_start(&filter, 0);
    sh_state_variable_filter_step(&filter, design, 1);
    for (k = 0; k < samples; k += 1) {
        const sh_real response = sh_state_variable_filter_second(&filter, design);
        sum += response * response;
        sh_state_variable_filter_step(&filter, design, 0);
    }
    return sum;
}
