/* What the three external functions of Sigmahat.Estimators.Internal.Estimator share. A tool may compile
 * each of them alone: then only sigmahat_estimator_new.c contains the library, and the others reach it
 * through the object.
 */
#ifndef SIGMAHAT_ESTIMATOR_H
#define SIGMAHAT_ESTIMATOR_H

#include "sigmahat.h"

typedef struct sigmahat_object sigmahat_object;

struct sigmahat_object {
    const sh_estimate *(*tick)(sigmahat_object *object, double t, const sh_measurement *z);
    sh_parameters parameters;
    sh_estimator now, before; /* before: as it was before the last tick */
    sh_estimate estimate, estimate_before;
    double t; /* of the last tick [s] */
    int ticked;
    int strained; /* 1: the message of a too large deformation was shown */
};

#endif
