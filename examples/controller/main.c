/* The estimator in the interrupt of a control loop at 1 kHz: docs/controller.md.
 *
 * The program runs for three seconds, changes a parameter after two, and prints the stiffness.
 */
#include <stdio.h>

#include "hardware.h"
#include "sigmahat.h"

enum { RATE = 1000, SECONDS = 3 };

/* All the memory that the estimator needs. */
static sh_parameters parameters;
static sh_estimator estimator;
static sh_estimate estimate;

/* Data from the interrupt to the main loop. The processor reads a number of one word as a whole. */
static volatile sh_real sigma, sigma_std;
static volatile uint32_t ticks, longest, missed;

void SysTick_Handler(void);

void SysTick_Handler(void)
{
    const sh_measurement z = hardware_read();
    uint32_t elapsed;

    if (sh_estimator_tick(&estimator, &parameters, &z, &estimate)) {
        ++missed; /* a measurement was not finite: the estimate did not change */
    }
    sigma = estimate.sigma;
    sigma_std = estimate.sigma_std;
    /* Here a controller would use estimate.sigma and set its torque. */
    ++ticks;
    elapsed = hardware_elapsed();
    if (elapsed > longest) {
        longest = elapsed;
    }
}

/* A joint with one transmission and no second motor that sets its stiffness: order 1 in the
 * set-point.
 */
static void configure(sh_parameters *p)
{
    sh_parameters_default(p);
    p->method = SH_METHOD_FILTERED_REGRESSION;
    p->samplePeriod = (sh_real)1 / RATE;
    p->rls.n = 2;
    p->rls.m = 1;
    p->range.phi = (sh_real)0.03; /* largest deformation [rad] */
    p->prior.tau_e = 5;           /* about the largest torque [N.m] */
}

int main(void)
{
    sh_violation violation;

    configure(&parameters);
    if (sh_parameters_check(&parameters, &violation)) {
        printf("%s: expected %s\n", violation.name, violation.range);
        return 1;
    }
    sh_estimator_start(&estimator, &parameters, &estimate);
    hardware_start_ticks(RATE);
    while (ticks < RATE * (SECONDS - 1)) {
        hardware_sleep();
    }
    /* Parameters change between ticks, not in the middle of one. */
    hardware_disable_interrupts();
    parameters.noise.tau = (sh_real)2e-3;
    hardware_enable_interrupts();
    while (ticks < RATE * SECONDS) {
        hardware_sleep();
    }
    hardware_disable_interrupts();
    printf("sigma = %.3f N.m/rad, standard deviation %.3f\n", (double)sigma, (double)sigma_std);
    printf("%lu ticks, %lu missed, the longest took %.1f %% of its period\n", (unsigned long)ticks,
           (unsigned long)missed, 100.0 * (double)longest / (double)hardware_period());
    return 0;
}
