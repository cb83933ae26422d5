#include "estimator_fmu.h"

#include <math.h>

sh_status sh_estimator_fmu_check(const sh_parameters *parameters, const char *who, sh_instance *log)
{
    sh_violation violation;

    if (!sh_parameters_check(parameters, &violation)) {
        return SH_OK;
    }
    sh_report(log, SH_ERROR, "%sParameter %s = %.9g is out of its range: %s.", who, violation.name,
              violation.value, violation.range);
    return SH_ERROR;
}

void sh_estimator_fmu_follow(sh_estimator_fmu *fmu, size_t offset)
{
    sh_parameters *p = &fmu->parameters;

    if (offset == offsetof(sh_estimator_fmu, parameters.residual.K_I)) {
        fmu->has_K_I = 1;
    } else if (offset == offsetof(sh_estimator_fmu, parameters.regression.bandwidth)) {
        fmu->has_bandwidth = 1;
    } else if (offset == offsetof(sh_estimator_fmu, parameters.samplePeriod)) {
        sh_parameters start;
        sh_parameters_default_at(&start, p->samplePeriod);
        p->residual.K_I = fmu->has_K_I ? p->residual.K_I : start.residual.K_I;
        p->regression.bandwidth =
            fmu->has_bandwidth ? p->regression.bandwidth : start.regression.bandwidth;
    }
}

void sh_estimator_fmu_initialize(sh_estimator_fmu *fmu)
{
    sh_estimator_start(&fmu->estimator, &fmu->parameters, &fmu->output);
    fmu->ahead = 0.0; /* the first tick is at the start time */
    fmu->strained = 0;
    fmu->until_sure = 0.0;
}

int sh_estimator_fmu_is_state(const sh_estimator_fmu *fmu, const sh_parameters *parameters)
{
    /* If `ahead`, the number of periods until the next tick, were far below 0 or NaN, a step would never end. */
    return fmu->ahead >= -1.0 && fmu->ahead <= 1.0 && fmu->until_sure >= 0.0 &&
           sh_estimator_check(&fmu->estimator, parameters) == 0;
}

/* Largest number of ticks in a communication step. A step with more ticks would take minutes. */
static const double MAX_TICKS = 1e9;

/* Extrapolates the inputs linearly to the time `after` [s], which counts from the start of the step. */
static sh_measurement extrapolate(const sh_estimator_fmu *fmu, double after)
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

/* Logs why a tick was skipped: one input is out of range, the sample is an outlier, or the regression overflows. */
static void log_skipped(const sh_measurement *z, int doubt, double t, const char *who,
                        sh_instance *log)
{
    static const char *const NAMES[] = {"theta", "q", "theta_c", "tau", "tau_e_sensor"};
    const double values[] = {z->theta, z->q, z->theta_c, z->tau, z->tau_e_sensor};
    size_t i;

    for (i = 0; i < sizeof values / sizeof values[0]; ++i) {
        if (!(fabs(values[i]) <= SH_LARGEST_MEASUREMENT)) {
            sh_report(
                log, SH_WARNING,
                "%sTick at t = %.9g s skipped, the estimate is kept: expected %s finite and at "
                "most %g in magnitude, received %g.",
                who, t, NAMES[i], SH_LARGEST_MEASUREMENT, values[i]);
            return;
        }
    }
    sh_report(
        log, SH_WARNING,
        "%sTick at t = %.9g s skipped, the estimate is kept: %s theta = %g, q = %g, tau = %g.", who,
        t,
        doubt == SH_DOUBT_OUTLIER ? "after the samples before, no joint can give"
                                  : "the regression overflows at",
        z->theta, z->q, z->tau);
}

/* The largest allowed deformation is slow to compute but never below range.phi, so range.phi is tested first. */
static int is_too_far(const sh_parameters *p, double phi)
{
    return fabs(phi) > p->range.phi && fabs(phi) > sh_parameters_largest_deformation(p);
}

static sh_status tick(sh_estimator_fmu *fmu, double t, double after, const char *who,
                      sh_instance *log)
{
    const sh_parameters *p = &fmu->parameters;
    const sh_measurement z = extrapolate(fmu, after);
    const int was_valid = fmu->output.valid;
    const double skipped = fmu->estimator.skipped;
    sh_status status = SH_OK;

    if (sh_estimator_tick(&fmu->estimator, p, &z, &fmu->output)) {
        status = SH_WARNING;
        if (was_valid) {
            log_skipped(&z, fmu->output.doubt, t + after, who, log);
        }
    } else if (!was_valid) {
        sh_report(log, SH_OK, "%sMeasurements are good again at t = %.9g s, %g ticks skipped.", who,
                  t + after, skipped);
    }
    if (!fmu->strained && is_too_far(p, fmu->output.phi)) {
        fmu->strained = 1;
        status = SH_WARNING;
        sh_report(log, SH_WARNING,
                  "%sDeformation phi = %g rad at t = %.9g s is more than %g times range.phi = %g "
                  "rad: expected a range.phi that covers it; the stiffness may be far off.",
                  who, fmu->output.phi, t + after,
                  sh_parameters_largest_deformation(p) / p->range.phi, p->range.phi);
    }
    return status;
}

/* Several ticks with the same inputs look like a motion in jumps. Values are not compared, because inputs may rest. The
 * regression takes the jumps for excitation, so its deviation is too small. A method without a claim needs no doubt.
 */
static void judge_inputs(sh_estimator_fmu *fmu, double h, double ticks, int held, sh_instance *log)
{
    const double T = fmu->parameters.samplePeriod;
    sh_estimate *output = &fmu->output;

    if (held && ticks > 1.0) {
        fmu->until_sure = ceil(1.0 / T);
        sh_warn_once(log,
                     "A communication step of %.9g s has %.0f ticks of samplePeriod = %.9g s with "
                     "the same inputs: the stiffness may be far off. Set samplePeriod to the "
                     "communication step, or the step of the importer (output_interval, step "
                     "size) to samplePeriod, or set input derivatives (FMI 2.0).",
                     h, ticks, T);
    } else {
        fmu->until_sure = fmu->until_sure > ticks ? fmu->until_sure - ticks : 0.0;
    }
    if (fmu->until_sure > 0.0 && output->doubt != SH_DOUBT_NO_CLAIM) {
        output->doubt = output->doubt > SH_DOUBT_HELD_INPUTS ? output->doubt : SH_DOUBT_HELD_INPUTS;
        output->confident = 0;
    }
}

/* Ticks are counted in sample periods, because the rounding errors of the importer's time add up. A communication step
 * of one sample period always contains exactly one tick, even after many steps.
 */
sh_status sh_estimator_fmu_step(sh_estimator_fmu *fmu, double t, double h, int held,
                                const char *who, sh_instance *log)
{
    const double T = fmu->parameters.samplePeriod, periods = h / T;
    /* A tick within the tolerance of the end of a step moves to the next step. Even tiny steps may have a tick. */
    const double tolerance = periods < 2e-6 ? periods / 2.0 : 1e-6;
    double ticks = 0.0;
    sh_status status = SH_OK;

    if (periods > MAX_TICKS) {
        sh_report(log, SH_ERROR,
                  "%sThe communication step of %g s is more than %g times samplePeriod = "
                  "%g s; expected a shorter step.",
                  who, h, MAX_TICKS, T);
        return SH_ERROR;
    }
    while (fmu->ahead < periods - tolerance) {
        /* Because of the tolerance, `ahead` can be slightly negative. */
        if (tick(fmu, t, fmu->ahead > 0.0 ? fmu->ahead * T : 0.0, who, log) != SH_OK) {
            status = SH_WARNING;
        }
        fmu->ahead += 1.0;
        ticks += 1.0;
    }
    fmu->ahead -= periods;
    judge_inputs(fmu, h, ticks, held, log);
    return status;
}
