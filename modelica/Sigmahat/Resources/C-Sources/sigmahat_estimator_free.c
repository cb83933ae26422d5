/* Destructor of Sigmahat.Estimators.Internal.Estimator. */
#ifndef SIGMAHAT_ESTIMATOR_FREE_C
#define SIGMAHAT_ESTIMATOR_FREE_C

#include <stdlib.h>

void sigmahat_estimator_free(void *object)
{
    free(object);
}

#endif
