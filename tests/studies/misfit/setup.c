#include "setup.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793

static const double LEAD = 0.0025 / (2 * PI); /* of the ball screw of the AwAS [m/rad] */

double setup_theta_c(const sim_parameters *p, double r)
{
    const double count = 2 * PI / 1024;

    return p->k_s > 0 ? floor((0.1 - r) / LEAD / count + 0.5) * count : 0;
}

void setup_without_candidates(sh_parameters *q)
{
    q->prior.power = q->prior.gap = q->prior.hysteresis = q->prior.eccentric_motor = 0;
}

void setup_without_new_columns(sh_parameters *q)
{
    q->prior.bias = q->prior.damping = q->prior.load_friction = q->prior.eccentric = 0;
    q->prior.delay = q->prior.reversal = 0;
}

void setup_parameters(const sim_parameters *p, const cat_given *given, sh_parameters *q)
{
    sh_parameters_default(q);
    q->method = SH_METHOD_FILTERED_REGRESSION;
    q->samplePeriod = (sh_real)p->T;
    q->rls.n = given->n;
    q->rls.m = given->m;
    q->range.phi = (sh_real)given->range_phi;
    q->noise.tau = (sh_real)given->noise_tau;
    q->motor.B = (sh_real)given->B;
    q->motor.D_theta = (sh_real)given->D;
    q->motor.gamma = (sh_real)p->gamma;
    q->encoder.theta = (sh_real)p->counts_theta;
    q->encoder.q = (sh_real)p->counts_q;
    q->prior.tau_e = (sh_real)given->prior_tau_e;
    q->prior.D_theta = (sh_real)given->prior_D;
    q->prior.B = (sh_real)given->prior_B;
    q->prior.tau_coulomb = (sh_real)given->prior_coulomb;
    q->prior.torque_gain = (sh_real)given->torque_gain;
}

void setup_tick(sh_estimator *estimator, const sh_parameters *q, const sim_sample *z,
                double theta_c, sh_estimate *estimate)
{
    sh_measurement m;

    m.theta = (sh_real)z->theta;
    m.q = (sh_real)z->q;
    m.theta_c = (sh_real)theta_c;
    m.tau = (sh_real)z->tau;
    m.tau_e_sensor = 0;
    sh_estimator_tick(estimator, q, &m, estimate);
}

void setup_sine(sim_parameters *p, double f, double A, double coulomb, uint64_t seed)
{
    memset(p, 0, sizeof *p);
    p->gain = 1;
    p->v_coulomb = 0.02;
    p->v_stribeck = 0.1;
    p->T = 1e-3;
    p->substeps = 4;
    p->noise_tau = sqrt(1e-5);
    p->noise_sensor = sqrt(1e-3);
    p->B = 2.3e-5;
    p->D = 1e-3;
    p->gamma = 50;
    p->tau_coulomb = coulomb;
    p->M = 0.1;
    p->D_q = 0.15;
    p->k_s = 14220;
    p->counts_theta = p->counts_q = 40000;
    p->torque.count = 1;
    p->torque.amplitude[0] = A;
    p->torque.omega[0] = 2 * PI * f;
    p->r_0 = 0.07 - 0.0157;
    p->arm.count = 1;
    p->arm.amplitude[0] = 0.0157;
    p->arm.omega[0] = 0.2 * PI;
    p->arm.phase[0] = PI / 2;
    p->seed = seed;
}
