/* An estimator inside an FMU: its variables, its state, and the time of its next tick. */
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
    double ahead; /* time from the communication point to the next tick [sample periods] */
    int strained; /* 1 after the warning about a too large deformation was logged */
} sh_estimator_fmu;

/* Offset in bytes from an input to the time derivative of this input in sh_estimator_fmu. */
enum {
    SH_ESTIMATOR_DERIVATIVE_OFFSET =
        (offsetof(sh_estimator_fmu, input_derivative) - offsetof(sh_estimator_fmu, input))
};

/* Like is_state of sh_model: returns 1 if the estimator can continue from its state with these parameters. */
int sh_estimator_fmu_is_state(const sh_estimator_fmu *fmu, const sh_parameters *parameters);

/* Like check, initialize and step of sh_model. The ticks are at t_k = start + k T. A step from t to t + h runs all
 * ticks with t <= t_k < t + h. Messages begin with `who`, the name of one of several estimators, or "".
 */
sh_status sh_estimator_fmu_check(const sh_parameters *parameters, const char *who,
                                 sh_instance *log);
void sh_estimator_fmu_initialize(sh_estimator_fmu *fmu);
sh_status sh_estimator_fmu_step(sh_estimator_fmu *fmu, double t, double h, const char *who,
                                sh_instance *log);

#endif
