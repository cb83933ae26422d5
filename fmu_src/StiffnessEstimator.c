/* Binding of the stiffness estimator to the FMI shell. */
#include <math.h>

#include "model.h"
#include "sample_clock.h"
#include "stiffness_estimator.h"

typedef struct {
    sh_parameters parameters;
    sh_measurement input;
    sh_measurement input_derivative;
    sh_estimate output;
    sh_estimator estimator;
    sh_sample_clock clock;
} StiffnessEstimator;

#include "variables.h"

static fmi2Status check(const void *model, sh_instance *log)
{
    const StiffnessEstimator *fmu = model;
    sh_violation violation;

    if (!sh_parameters_check(&fmu->parameters, &violation))
        return fmi2OK;
    sh_log(log, fmi2Error, "Parameter %s = %.9g is out of its range: %s.", violation.name,
           violation.value, violation.range);
    return fmi2Error;
}

static void initialize(void *model, double start_time)
{
    StiffnessEstimator *fmu = model;

    (void)start_time;
    sh_estimator_start(&fmu->estimator, &fmu->parameters, &fmu->output);
    sh_sample_clock_start(&fmu->clock);
}

/* Inputs at a time after the begin of the step. */
static sh_measurement extrapolate(const StiffnessEstimator *fmu, double after)
{
    const sh_measurement *u = &fmu->input, *du = &fmu->input_derivative;
    sh_measurement z;

    z.theta = u->theta + du->theta * after;
    z.q = u->q + du->q * after;
    z.theta_c = u->theta_c + du->theta_c * after;
    z.tau = u->tau + du->tau * after;
    z.tau_e_sensor = u->tau_e_sensor + du->tau_e_sensor * after;
    return z;
}

static fmi2Status step(void *model, double t, double h, sh_instance *log)
{
    StiffnessEstimator *fmu = model;
    fmi2Status status = fmi2OK;
    double after;

    while (sh_sample_clock_tick(&fmu->clock, h, fmu->parameters.samplePeriod, &after)) {
        const sh_measurement z = extrapolate(fmu, after);
        const int was_valid = fmu->output.valid;
        const double skipped = fmu->estimator.skipped;

        if (!sh_estimator_tick(&fmu->estimator, &fmu->parameters, &z, &fmu->output)) {
            status = fmi2Warning;
            if (was_valid)
                sh_log(log, fmi2Warning,
                       "Tick at t = %.9g s skipped, the estimate is kept: expected finite "
                       "measurements, came theta = %g, q = %g, theta_c = %g, tau = %g, "
                       "tau_e_sensor = %g.",
                       t + after, z.theta, z.q, z.theta_c, z.tau, z.tau_e_sensor);
        } else if (!was_valid) {
            sh_log(log, fmi2OK, "Measurements are good again at t = %.9g s, %g ticks skipped.",
                   t + after, skipped);
        }
    }
    return status;
}

const sh_model sh_fmu_model = {
    .identifier = SH_IDENTIFIER,
    .guid = SH_GUID,
    .size = sizeof(StiffnessEstimator),
    .variables = VARIABLES,
    .count = sizeof VARIABLES / sizeof VARIABLES[0],
    .derivative_offset =
        offsetof(StiffnessEstimator, input_derivative) - offsetof(StiffnessEstimator, input),
    .check = check,
    .initialize = initialize,
    .step = step,
};
