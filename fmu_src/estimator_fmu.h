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
    double ahead;      /* time from the communication point to the next tick [sample periods] */
    int strained;      /* 1 after the warning about a too large deformation was logged */
    double until_sure; /* ticks until the estimate may be trusted after a step with held inputs */
    int has_K_I, has_bandwidth; /* 1: the importer has set this parameter; 0: it has a start value,
                                   which follows samplePeriod */
} sh_estimator_fmu;

/* Offset in bytes from an input to the time derivative of this input in sh_estimator_fmu. */
enum {
    SH_ESTIMATOR_DERIVATIVE_OFFSET =
        (offsetof(sh_estimator_fmu, input_derivative) - offsetof(sh_estimator_fmu, input))
};

/* Like is_state of sh_model: returns 1 if the estimator can continue from its state with these parameters. */
int sh_estimator_fmu_is_state(const sh_estimator_fmu *fmu, const sh_parameters *parameters);

/* Like check, follow, initialize and step of sh_model. The ticks are at t_k = start + k T. A step from t to t + h runs all
 * ticks with t <= t_k < t + h. A step of several ticks with held inputs gives a warning, and a doubt for one second
 * (SH_DOUBT_HELD_INPUTS). Messages begin with `who`, the name of one of several estimators, or "".
 */
sh_status sh_estimator_fmu_check(const sh_parameters *parameters, const char *who,
                                 sh_instance *log);
void sh_estimator_fmu_follow(sh_estimator_fmu *fmu, size_t offset);
void sh_estimator_fmu_initialize(sh_estimator_fmu *fmu);
sh_status sh_estimator_fmu_step(sh_estimator_fmu *fmu, double t, double h, int held,
                                const char *who, sh_instance *log);

#endif
