/* Constructor of Sigmahat.Estimators.Internal.Estimator, with the library. */
#ifndef SIGMAHAT_ESTIMATOR_NEW_C
#define SIGMAHAT_ESTIMATOR_NEW_C

#include <stdlib.h>
#include <string.h>

#include "ModelicaUtilities.h"
#include "sigmahat.c"
#include "sigmahat_estimator.h"

/* Runs a tick, and tells what the user has to know, once. A tool may evaluate the equations of one moment
 * several times: a second tick at the same time replaces the first.
 */
static const sh_estimate *sigmahat_tick(sigmahat_object *o, double t, const sh_measurement *z)
{
    const sh_real largest = sh_parameters_largest_deformation(&o->parameters);

    if (o->ticked && t <= o->t) {
        o->now = o->before;
        o->estimate = o->estimate_before;
    } else {
        o->before = o->now;
        o->estimate_before = o->estimate;
    }
    o->t = t;
    o->ticked = 1;
    if (sh_estimator_tick(&o->now, &o->parameters, z, &o->estimate) && o->estimate_before.valid) {
        ModelicaFormatMessage(
            "StiffnessEstimator: tick at t = %.9g s skipped, the estimate is kept: expected "
            "inputs that are finite and at most 1e12 in magnitude, received theta = %g, q = %g, "
            "theta_c = %g, tau = %g, tau_e_sensor = %g.\n",
            t, z->theta, z->q, z->theta_c, z->tau, z->tau_e_sensor);
    }
    if (!o->strained && (o->estimate.phi > largest || o->estimate.phi < -largest)) {
        o->strained = 1;
        ModelicaFormatMessage(
            "StiffnessEstimator: deformation phi = %g rad at t = %.9g s is far beyond range.phi "
            "= %g rad: expected a range.phi that covers it; the stiffness may be far off.\n",
            o->estimate.phi, t, o->parameters.range.phi);
    }
    return &o->estimate;
}

static void sigmahat_set_filter(sh_filter_parameters *p, const double *filter)
{
    p->V_a = filter[0];
    p->V_max = filter[1];
    p->V_min = filter[2];
    p->alpha = filter[3];
    p->R = filter[4];
    p->P_0 = filter[5];
}

static void sigmahat_set_prior(sh_prior_parameters *p, const double *prior)
{
    p->tau_e = prior[0];
    p->nominal = prior[1];
    p->D_theta = prior[2];
    p->B = prior[3];
    p->tau_coulomb = prior[4];
    p->torque_gain = prior[5];
    p->bias = prior[6];
    p->damping = prior[7];
    p->load_friction = prior[8];
    p->eccentric = prior[9];
    p->delay = prior[10];
    p->reversal = prior[11];
    p->power = prior[12];
    p->gap = prior[13];
    p->hysteresis = prior[14];
    p->eccentric_motor = prior[15];
}

/* Arrays hold the fields of the record of the same name, in its order. Enumerations count from 1, as in the
 * library.
 */
void *sigmahat_estimator_new(double samplePeriod, int method, int modality, int deformation,
                             int filterKind, int weighting, int rlsKind, int symmetric, int n,
                             int m, int held, double relativeStd, const double *motor, double K_I,
                             const double *filter, const double *encoder, const double *setPoint,
                             const double *rls, const double *eta_0, const double *nominal,
                             const double *noise, const double *regression, const double *range,
                             const double *prior)
{
    sh_parameters p;
    sh_violation violation;
    sigmahat_object *object;
    int i, j;

    sh_parameters_default(&p);
    p.samplePeriod = samplePeriod;
    p.method = method;
    p.modality = modality;
    p.deformation = deformation;
    p.motor.B = motor[0];
    p.motor.D_theta = motor[1];
    p.motor.gamma = motor[2];
    p.residual.K_I = K_I;
    p.filter.kind = filterKind;
    p.filter.weighting = weighting;
    sigmahat_set_filter(&p.filter, filter);
    p.encoder.theta = encoder[0];
    p.encoder.q = encoder[1];
    p.setPoint.offset = setPoint[0];
    p.setPoint.scale = setPoint[1];
    p.rls.kind = rlsKind;
    p.rls.symmetric = symmetric != 0;
    p.rls.n = n;
    p.rls.m = m;
    p.rls.P_0 = rls[0];
    p.rls.c = rls[1];
    p.rls.a = rls[2];
    for (i = 0; i < SH_MAX_N; ++i) {
        for (j = 0; j < SH_MAX_M; ++j) {
            p.rls.eta_0[i][j] = eta_0[i * SH_MAX_M + j];
        }
    }
    p.model.k_s = nominal[0];
    p.model.r_0 = nominal[1];
    p.model.b = nominal[2];
    p.noise.tau = noise[0];
    p.noise.tau_e = noise[1];
    p.limit.relative_std = relativeStd;
    p.torque.held = held != 0;
    p.regression.bandwidth = regression[0];
    p.regression.slow = regression[1];
    p.regression.drift = regression[2];
    p.regression.memory = regression[3];
    p.range.phi = range[0];
    p.range.setPoint = range[1];
    sigmahat_set_prior(&p.prior, prior);

    if (sh_parameters_check(&p, &violation)) {
        /* "model" is a keyword of Modelica: the record is called nominal there. */
        const int renamed = strncmp(violation.name, "model.", 6) == 0;
        ModelicaFormatError("StiffnessEstimator: parameter %s%s = %.9g is out of its range: %s.\n",
                            renamed ? "nominal." : "", violation.name + (renamed ? 6 : 0),
                            violation.value, violation.range);
        return NULL; /* not reached */
    }
    object = malloc(sizeof *object);
    if (object == NULL) {
        ModelicaError("StiffnessEstimator: there is no memory for another estimator.\n");
        return NULL; /* not reached */
    }
    object->tick = sigmahat_tick;
    object->parameters = p;
    sh_estimator_start(&object->now, &p, &object->estimate);
    object->before = object->now;
    object->estimate_before = object->estimate;
    object->t = 0.0;
    object->ticked = 0;
    object->strained = 0;
    return object;
}

#endif
