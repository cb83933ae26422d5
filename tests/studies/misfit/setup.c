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

double setup_set_point(double theta_c)
{
    return 100 - LEAD * 1000 * theta_c;
}

void setup_settings(const sim_parameters *p, const cat_given *given, est_settings *s)
{
    est_defaults(s);
    s->T = (sh_real)p->T;
    s->n = given->n;
    s->m = given->m;
    s->range_phi = (sh_real)given->range_phi;
    s->range_set = 100;
    s->noise = (sh_real)given->noise_tau;
    s->gamma = (sh_real)p->gamma;
    s->B = (sh_real)given->B;
    s->D = (sh_real)given->D;
    s->count = (sh_real)(2 * PI / p->counts_theta);
    s->count_q = (sh_real)(2 * PI / p->counts_q);
    s->prior.tau_e = (sh_real)given->prior_tau_e;
    s->prior.D = (sh_real)given->prior_D;
    s->prior.B = (sh_real)given->prior_B;
    s->prior.tau_coulomb = (sh_real)given->prior_coulomb;
    s->prior.torque_gain = (sh_real)given->torque_gain;
}

void setup_without_candidates(est_settings *s)
{
    s->prior.power = s->prior.gap = s->prior.hysteresis = s->prior.eccentric_motor = 0;
}

void setup_without_new_columns(est_settings *s)
{
    s->prior.bias = s->prior.lag = s->prior.load_friction = s->prior.eccentric = 0;
    s->prior.delay = s->prior.reversal = 0;
}

/* Largest bandwidth at which the noise of the torque is at least as large as that of theta''. */
static double bandwidth_of(const sim_parameters *p, const cat_given *given)
{
    const double noise = 2 * PI / p->counts_theta / sqrt(12.0);

    return fmin(350, 1.42 * sqrt(given->noise_tau / (given->B * p->gamma * noise)));
}

void setup_parameters(const sim_parameters *p, const cat_given *given, sh_parameters *q)
{
    sh_parameters_default(q);
    q->method = SH_METHOD_MATCHED_FILTER;
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
    q->matched.bandwidth = (sh_real)bandwidth_of(p, given);
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
