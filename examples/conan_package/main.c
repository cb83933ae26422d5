/* Estimates the stiffness of a simulated spring of 150 N.m/rad, whose torque a sensor measures. */
#include <math.h>
#include <stdio.h>

#include "sigmahat.h"

static sh_parameters parameters;
static sh_estimator estimator;
static sh_estimate estimate;

int main(void)
{
    const double stiffness = 150.0;
    sh_violation violation;
    int k;

    sh_parameters_default(&parameters);
    parameters.modality = SH_MODALITY_SENSOR;
    parameters.rls.n = 1; /* a linear spring */
    parameters.rls.m = 1;
    parameters.rls.c = (sh_real)1e-14; /* the motion is small */
    if (sh_parameters_check(&parameters, &violation)) {
        printf("%s: expected %s\n", violation.name, violation.range);
        return 1;
    }
    sh_estimator_start(&estimator, &parameters, &estimate);
    for (k = 0; k < 2000; ++k) {
        const double phi = 0.02 * sin(0.006 * k);
        sh_measurement z = {0};

        z.q = (sh_real)phi;
        z.tau_e_sensor = (sh_real)(stiffness * phi);
        sh_estimator_tick(&estimator, &parameters, &z, &estimate);
    }
    printf("sigma = %.2f N.m/rad; a number has %u bytes, an instance %u\n", (double)estimate.sigma,
           (unsigned)sizeof(sh_real),
           (unsigned)(sizeof estimator + sizeof parameters + sizeof estimate));
    return fabs((double)estimate.sigma / stiffness - 1) < 0.01 ? 0 : 1;
}
