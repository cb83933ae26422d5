/* Whether the motor was at rest at the first sample, as the filters assume (section 13). */
#include "real_math.h"
#include "regression.h"
#include "state_variable_filter.h"

/* Share of its way that a motor covers in the first half of the time [1]: 1/4 or less from rest, 1/2 at constant
 * velocity.
 */
#define SH_FIRST_HALF ((sh_real)0.3)
/* Standard deviations of a noisy position that count as its resolution [1]. */
#define SH_SURELY ((sh_real)5)

void sh_rest_start(sh_rest *rest, const sh_filter_design *design)
{
    const sh_rest nothing = {0};

    *rest = nothing;
    rest->most = (int)(SH_FORGOTTEN / (design->w * design->T)) + 1;
    rest->next = 2;
}

void sh_rest_end(sh_rest *rest)
{
    rest->taken = rest->most + 1;
}

/* (F29). The test ends as soon as it is certain, because later an oscillation of the motor against the spring looks like any
 * motion. Positions that are rounded by half a count each change `too_far` by at most one count.
 */
int sh_rest_take(sh_rest *rest, sh_real theta, sh_real count, sh_real rough)
{
    const int k = rest->taken;
    const sh_real way = theta - rest->first, half = rest->middle - rest->first;
    const sh_real too_far = sh_fabs(half) - SH_FIRST_HALF * sh_fabs(way);
    const sh_real resolution = sh_fmax(count, SH_SURELY * sh_sqrt(rough));

    if (!sh_rest_is_open(rest) || k > SH_LONGEST_REST) {
        return 0;
    }
    rest->taken = k + 1;
    if (k == 0) {
        rest->first = theta;
    }
    if (k == 1) {
        rest->middle = theta;
    }
    if (k < rest->next) {
        return 0;
    }
    rest->middle = theta;
    rest->next = 2 * k;
    if (sh_fabs(too_far) > resolution) {
        sh_rest_end(rest);
    }
    return too_far > resolution;
}
