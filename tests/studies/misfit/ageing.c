/* ageing: the springs of the AwAS get 30 % softer between 20 and 40 s of motion at 1 Hz; from 60 s
 * on the motor gets no torque. Prints RMS error and claim of each 10 s, in per cent.
 */
#include <math.h>
#include <stdio.h>

#include "setup.h"

enum { TENS = 11 };

/* One run. prior_B is prior.B, drift is regression.drift. */
static void run(double prior_B, double drift)
{
    static sh_estimator e;
    sim_parameters p;
    sim plant;
    sh_parameters q;
    sh_estimate out;
    double error[TENS] = {0}, claim[TENS] = {0};
    int n[TENS] = {0}, k;

    setup_sine(&p, 1, 0.3, 0, 1);
    p.k_drift = -0.3;
    p.drift_time = -20; /* from 20 to 40 s */
    sim_start(&plant, &p);
    sh_parameters_default(&q);
    q.method = SH_METHOD_FILTERED_REGRESSION;
    q.rls.n = 3;
    q.motor.D_theta = (sh_real)1.1e-3;
    q.prior.torque_gain = 0;
    q.prior.B = (sh_real)prior_B;
    q.regression.drift = (sh_real)drift;
    sh_estimator_start(&e, &q, &out);
    for (k = 0; k < 105000; ++k) {
        const double t = k * 1e-3;
        const int ten = (int)(t / 10);
        sim_sample z;

        if (k == 60000) {
            p.torque.count = 0;
        }
        sim_next(&plant, &z);
        setup_tick(&e, &q, &z, setup_theta_c(&p, z.r), &out);
        if (t > 1) {
            error[ten] += pow((double)out.sigma / z.sigma - 1, 2);
            claim[ten] += pow((double)out.sigma_std / z.sigma, 2);
            n[ten] += 1;
        }
    }
    printf("B %g drift %g: ", prior_B, drift);
    for (k = 0; k < TENS; ++k) {
        printf(" %.2f/%.2f", 100 * sqrt(error[k] / n[k]), 100 * sqrt(claim[k] / n[k]));
    }
    printf("\n");
}

int main(void)
{
    run(0, 0);
    run(0.1, 0);
    run(0, 1e-3);
    run(0.1, 1e-3);
    return 0;
}
