/* Sigmahat.Estimators.Internal.tick. */
#ifndef SIGMAHAT_ESTIMATOR_TICK_C
#define SIGMAHAT_ESTIMATOR_TICK_C

#include <string.h>

#include "sigmahat_estimator.h"

void sigmahat_estimator_tick(void *estimator, double t, double theta, double q, double theta_c,
                             double tau, double tau_e_sensor, double *sigma, double *tau_e,
                             double *tau_e_residual, double *theta_dot, double *phi,
                             double *setPoint, double *a, double *rho, double *epsilon, double *eta,
                             double *sigma_std, double *tau_e_std, double *D_theta_hat,
                             double *B_hat, double *tau_coulomb_hat, double *misfit,
                             double *bias_hat, double *damping_hat, double *load_friction_hat,
                             double *eccentric_hat, double *delay_hat, double *hysteresis_hat,
                             double *sigma_per_gain, int *doubt, int *confident, int *valid)
{
    sigmahat_object *object = estimator;
    sh_measurement z;
    const sh_estimate *e;

    z.theta = theta;
    z.q = q;
    z.theta_c = theta_c;
    z.tau = tau;
    z.tau_e_sensor = tau_e_sensor;
    e = object->tick(object, t, &z);
    *sigma = e->sigma;
    *tau_e = e->tau_e;
    *tau_e_residual = e->tau_e_residual;
    *theta_dot = e->theta_dot;
    *phi = e->phi;
    *setPoint = e->setPoint;
    *a = e->a;
    *rho = e->rho;
    *epsilon = e->epsilon;
    memcpy(eta, e->eta, sizeof e->eta);
    *sigma_std = e->sigma_std;
    *tau_e_std = e->tau_e_std;
    *D_theta_hat = e->D_theta_hat;
    *B_hat = e->B_hat;
    *tau_coulomb_hat = e->tau_coulomb_hat;
    *misfit = e->misfit;
    *bias_hat = e->bias_hat;
    *damping_hat = e->damping_hat;
    *load_friction_hat = e->load_friction_hat;
    *eccentric_hat = e->eccentric_hat;
    *delay_hat = e->delay_hat;
    *hysteresis_hat = e->hysteresis_hat;
    *sigma_per_gain = e->sigma_per_gain;
    *doubt = e->doubt;
    *confident = e->confident;
    *valid = e->valid;
}

#endif
