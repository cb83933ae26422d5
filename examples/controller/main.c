/* Example of the estimator in the interrupt of a control loop at 1 kHz, see docs/controller.md.
 *
 * The program runs for three seconds, changes a parameter after two seconds, and prints the stiffness.
 */
#include <stdio.h>

#include "hardware.h"
#include "sigmahat.h"

enum { RATE = 1000, SECONDS = 3 };

/* The estimator needs no other memory than the structs of parameters, state and estimate. */
static sh_parameters parameters;
static sh_estimator estimator;
static sh_estimate estimate;

/* Values that the interrupt passes to the main loop. The processor reads a variable of one word atomically. */
static volatile sh_real sigma, sigma_std;
static volatile uint32_t ticks, longest, missed;

void SysTick_Handler(void);

void SysTick_Handler(void)
{
    const sh_measurement z = hardware_read();
    uint32_t elapsed;

    if (sh_estimator_tick(&estimator, &parameters, &z, &estimate)) {
        ++missed; /* a measurement was not finite, so the estimate did not change */
    }
    sigma = estimate.sigma;
    sigma_std = estimate.sigma_std;
    /* A real controller would now use estimate.sigma to compute its torque. */
    ++ticks;
    elapsed = hardware_elapsed();
    if (elapsed > longest) {
        longest = elapsed;
    }
}

/* Sets the parameters for a joint without a second motor that adjusts the stiffness. Without a second motor, rls.m,
 * the number of powers of the set-point, is 1.
 */
static void configure(sh_parameters *p)
{
    sh_parameters_default_at(p, (sh_real)1 / RATE);
    p->method = SH_METHOD_FILTERED_REGRESSION;
    p->rls.n = 2;
    p->rls.m = 1;
    p->range.phi = (sh_real)0.03; /* largest expected deformation [rad] */
    p->prior.tau_e = 5;           /* approximately the largest torque [N.m] */
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
    /* Disabled interrupts make sure that parameters change between two ticks, and not during a tick. */
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
