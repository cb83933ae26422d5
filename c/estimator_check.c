/* Checks whether an estimator state, for example from a file, can be used with the parameters. */
#include <stddef.h>

#include "method.h"
#include "real_math.h"

typedef int state_check(const sh_estimator *estimator, const sh_parameters *p);

#define SH_STATE_CHECK(constant, number, name, block) [constant] = block##_check_state,
static state_check *const STATE_CHECKS[] = {SH_METHODS(SH_STATE_CHECK)};

int sh_estimator_check(const sh_estimator *estimator, const sh_parameters *p)
{
    if (sh_method_of(p) == NULL || estimator->started < 0 || estimator->started > 1) {
        return 1;
    }
    if (estimator->skipped < 0 || estimator->skipped > SH_MOST_TICKS) {
        return 1;
    }
    return STATE_CHECKS[p->method](estimator, p);
}
