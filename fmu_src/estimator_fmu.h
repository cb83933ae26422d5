/* One estimator inside an FMU: variables, state and clock. */
#ifndef SH_ESTIMATOR_FMU_H
#define SH_ESTIMATOR_FMU_H

#include "model.h"
#include "sigmahat.h"

typedef struct {
    sh_parameters parameters;
    sh_measurement input;
    sh_measurement input_derivative;
    sh_estimate output;
    sh_estimator estimator;
    double ahead; /* next tick, in periods after the communication point */
    int strained; /* 1: the warning of a too large deformation was logged */
} sh_estimator_fmu;

/* Offset from an input to its time derivative. */
enum {
    SH_ESTIMATOR_DERIVATIVE_OFFSET =
        (offsetof(sh_estimator_fmu, input_derivative) - offsetof(sh_estimator_fmu, input))
};

/* As is_state of sh_model; with the parameters that the estimator uses. */
int sh_estimator_fmu_is_state(const sh_estimator_fmu *fmu, const sh_parameters *parameters);

/* As in sh_model. Ticks are at t_k = start + k T: a step from t to t + h runs all ticks with
 * t <= t_k < t + h. Messages begin with `who`: "", or the name of one of several estimators.
 */
sh_status sh_estimator_fmu_check(const sh_parameters *parameters, const char *who,
                                 sh_instance *log);
void sh_estimator_fmu_initialize(sh_estimator_fmu *fmu);
sh_status sh_estimator_fmu_step(sh_estimator_fmu *fmu, double t, double h, const char *who,
                                sh_instance *log);

#endif
