#include "state_variable_filter.h"

#include <math.h>

sh_filter_design sh_state_variable_filter_design(double w, double T)
{
    const double wT = w * T, decay = exp(-wT);
    sh_filter_design design;

    design.w = w;
    design.T = T;
    design.keep[0] = decay;
    design.keep[1] = decay * wT;
    design.keep[2] = decay * wT * wT / 2.0;
    return design;
}

void sh_state_variable_filter_start(sh_state_variable_filter *filter, double x)
{
    filter->input = x;
    filter->stage[0] = x;
    filter->stage[1] = x;
    filter->stage[2] = x;
}

void sh_state_variable_filter_begin(sh_state_variable_filter *filter, double x)
{
    sh_state_variable_filter_start(filter, 0.0);
    filter->input = x;
}

/* Advances by T. In the steady state of a ramp, stage i runs behind it by i + 1 times lag;
 * deviations from that die out as in the unforced filter.
 */
static void advance(sh_state_variable_filter *filter, const sh_filter_design *design, double from,
                    double to, double lag)
{
    const double *keep = design->keep;
    const double d0 = filter->stage[0] - (from - lag);
    const double d1 = filter->stage[1] - (from - 2.0 * lag);
    const double d2 = filter->stage[2] - (from - 3.0 * lag);

    filter->stage[0] = to - lag + keep[0] * d0;
    filter->stage[1] = to - 2.0 * lag + keep[0] * d1 + keep[1] * d0;
    filter->stage[2] = to - 3.0 * lag + keep[0] * d2 + keep[1] * d1 + keep[2] * d0;
}

void sh_state_variable_filter_step(sh_state_variable_filter *filter,
                                   const sh_filter_design *design, double x)
{
    advance(filter, design, filter->input, x, (x - filter->input) / (design->w * design->T));
    filter->input = x;
}

void sh_state_variable_filter_step_mean(sh_state_variable_filter *filter,
                                        const sh_filter_design *design, double mean)
{
    advance(filter, design, mean, mean, 0.0);
}

double sh_state_variable_filter_first(const sh_state_variable_filter *filter,
                                      const sh_filter_design *design)
{
    return design->w * (filter->stage[1] - filter->stage[2]);
}

double sh_state_variable_filter_second(const sh_state_variable_filter *filter,
                                       const sh_filter_design *design)
{
    return design->w * design->w *
           (filter->stage[0] - 2.0 * filter->stage[1] + filter->stage[2]);
}

double sh_state_variable_filter_noise(const sh_filter_design *design)
{
    /* Sum of squares of the response to one sample; it has died out after 60 time constants. */
    const int samples = 2 + (int)ceil(60.0 / (design->w * design->T));
    sh_state_variable_filter filter;
    double sum = 0.0;
    int k;

    sh_state_variable_filter_start(&filter, 0.0);
    sh_state_variable_filter_step(&filter, design, 1.0);
    for (k = 0; k < samples; ++k) {
        const double response = sh_state_variable_filter_second(&filter, design);
        sum += response * response;
        sh_state_variable_filter_step(&filter, design, 0.0);
    }
    return sum;
}
