/* Runs one estimator for any number of ticks: METHOD N M TORQUE TICKS.
 *
 * TORQUE is the size of a huge torque in the input, in multiples of the usual torque. After every
 * tick, P or its inverse has to be positive definite and every output finite; if not, the program
 * prints the number of the tick and ends with 1. It prints the outputs at checkpoints, one line
 * each: every time the number of ticks has grown by a third.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "endurance_input.h"
#include "sigmahat.h"

static int positive(const sh_real *D, int size)
{
    int j;

    for (j = 0; j < size; ++j) {
        if (!(D[j] > 0.0)) {
            return 0;
        }
    }
    return 1;
}

/* Covariance or information, with the factors U D U' or U' D U and a unit triangular U, is positive
 * definite.
 */
static int definite(const sh_estimator *estimator, const sh_parameters *p)
{
    const sh_ud_factor *P = &estimator->method.paper2011.rls.P;
    const sh_regression_state *regression = &estimator->method.regression;
    const sh_information *posterior = &regression->posterior.information, *data = &regression->data;

    if (p->method == SH_METHOD_PAPER2011) {
        return positive(P->D, P->size);
    }
    return positive(posterior->D, posterior->size) && positive(data->D, data->size);
}

static int finite_outputs(const sh_estimate *e)
{
    return isfinite(e->sigma + e->tau_e + e->tau_e_residual + e->theta_dot + e->phi + e->setPoint +
                    e->a + e->rho + e->epsilon + e->sigma_std + e->tau_e_std + e->D_theta_hat +
                    e->B_hat + e->tau_coulomb_hat + e->misfit + e->bias_hat + e->damping_hat +
                    e->load_friction_hat + e->eccentric_hat + e->delay_hat + e->hysteresis_hat +
                    e->sigma_per_gain);
}

static void print(long tick, const sh_estimate *e)
{
    const sh_real out[] = {e->sigma,     e->tau_e,       e->sigma_std, e->tau_e_residual,
                           e->theta_dot, e->D_theta_hat, e->B_hat,     e->tau_coulomb_hat};
    size_t i;

    printf("%ld", tick);
    for (i = 0; i < sizeof out / sizeof out[0]; ++i) {
        printf(" %.20Lg", (long double)out[i]);
    }
    printf("\n");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    static sh_parameters p;
    static sh_estimator estimator;
    static sh_estimate estimate;
    static input_stream input;
    sh_violation violation;
    long ticks, tick, next = 10;

    if (argc != 6) {
        return 2;
    }
    sh_parameters_default(&p);
    p.method = atoi(argv[1]);
    p.rls.n = atoi(argv[2]);
    p.rls.m = atoi(argv[3]);
    ticks = atol(argv[5]);
    p.encoder.theta = p.encoder.q = INPUT_COUNTS;
    p.prior.B = 0.1;
    p.prior.tau_coulomb = 0.02;
    p.regression.drift = 1e-3;
    if (sh_parameters_check(&p, &violation)) {
        fprintf(stderr, "%s has to be %s\n", violation.name, violation.range);
        return 2;
    }
    sh_estimator_start(&estimator, &p, &estimate);
    input_start(&input, atof(argv[4]));
    for (tick = 1; tick <= ticks; ++tick) {
        const input_sample s = input_next(&input);
        const sh_measurement z = {s.theta, s.q, s.theta_c, s.tau, s.tau_e_sensor};

        p.modality = s.modality;
        sh_estimator_tick(&estimator, &p, &z, &estimate);
        if (!definite(&estimator, &p) || !finite_outputs(&estimate)) {
            print(tick, &estimate);
            fprintf(stderr, "failed at tick %ld\n", tick);
            return 1;
        }
        if (tick == next || tick == ticks) {
            print(tick, &estimate);
        }
        if (tick == next) {
            next += next / 3 + 1;
        }
    }
    return 0;
}
