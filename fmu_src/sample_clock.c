#include "sample_clock.h"

#include <math.h>

void sh_sample_clock_start(sh_sample_clock *clock)
{
    clock->ahead = 0.0;
}

int sh_sample_clock_is_state(const sh_sample_clock *clock)
{
    return clock->ahead >= -1.0 && clock->ahead <= 1.0; /* false if it is not a number */
}

int sh_sample_clock_tick(sh_sample_clock *clock, double h, double T, double *after)
{
    const double step = h / T;
    const double tolerance = fmin(1e-6, step / 2.0); /* a step of any length counts */

    if (clock->ahead < step - tolerance) {
        *after = fmax(clock->ahead, 0.0) * T; /* it may be negative by the tolerance */
        clock->ahead += 1.0;
        return 1;
    }
    clock->ahead -= step;
    return 0;
}
