/* Checks whether a state is possible for the method Paper2011. Only the number of parameters limits the indices. */
#include "method.h"

int sh_paper2011_check_state(const sh_estimator *estimator, const sh_parameters *p)
{
    if (estimator->method.paper2011.rls.P.size != p->rls.n * p->rls.m) {
        return 1;
    }
    return 0;
}
