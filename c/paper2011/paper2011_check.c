/* Method Paper2011: which states can be its own. All loops and places follow from the number of
 * parameters alone.
 */
#include "method.h"

int sh_paper2011_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    if (estimator->method.paper2011.rls.P.size != p->rls.n * p->rls.m) {
        return 1;
    }
    return 0;
}
