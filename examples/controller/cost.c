/* Cost of the estimator on this controller: instructions and stack of a tick, RAM of an instance. The orders are 6 in
 * the deformation and 3 in the set-point, or SH_MAX_N and SH_MAX_M
 * if these are smaller.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hardware.h"
#include "sigmahat.h"

enum { TICKS = 2000, PAINTED = 4096, PAINT = 0xa5 };

static sh_parameters parameters;
static sh_estimator estimator;
static sh_estimate estimate;
static sh_measurement z;

/* The joint of hardware.h with a slow set-point. */
static void measure(int k)
{
    z = hardware_read();
    z.theta_c = 75 + (sh_real)(k % 1000) / 200;
}

static void tick(void)
{
    sh_estimator_tick(&estimator, &parameters, &z, &estimate);
}

/* A loop of 2 instructions per turn, to measure the counts of the clock per instruction. */
static void loop(void)
{
    uint32_t turns = 100000;

    __asm volatile("1: subs %0, #1\n\tbne 1b" : "+r"(turns)::"cc");
}

static void nothing(void)
{
}

/* Counts of the clock that a function takes; the clock has 24 bits and counts down. */
static uint32_t counts(void (*function)(void))
{
    const uint32_t before = hardware_clock();

    function();
    return (before - hardware_clock()) & 0xffffffu;
}

/* Bytes of the stack below this function that another one writes to. */
static unsigned __attribute__((noinline)) stack(void (*function)(void))
{
    volatile unsigned char *const top = __builtin_frame_address(0);
    unsigned depth = PAINTED;
    unsigned i;

    for (i = 64; i < PAINTED; ++i) { /* the frame of this function is in the first 64 */
        top[-(int)i] = PAINT;
    }
    function();
    while (depth > 64 && top[-(int)depth + 1] == PAINT) {
        --depth;
    }
    return depth;
}

/* Leaves the columns of the spring, the bias, and the friction of the motor. */
static void remove_columns(void)
{
    const sh_prior_parameters before = parameters.prior;

    memset(&parameters.prior, 0, sizeof parameters.prior);
    parameters.prior.tau_e = before.tau_e;
    parameters.prior.bias = before.bias;
    parameters.prior.D_theta = before.D_theta;
    parameters.prior.tau_coulomb = before.tau_coulomb;
}

static void report(const char *name, double per_count)
{
    double sum = 0.0, longest = 0.0;
    unsigned deepest = 0;
    sh_violation violation;
    int k;

    if (sh_parameters_check(&parameters, &violation)) {
        printf("%s: %s is not possible with these sizes, expected %s\n", name, violation.name,
               violation.range);
        return;
    }
    sh_estimator_start(&estimator, &parameters, &estimate);
    for (k = 0; k < TICKS; ++k) {
        double instructions;
        measure(k);
        instructions = per_count * (double)(counts(tick) - counts(nothing));
        sum += instructions;
        longest = fmax(longest, instructions);
    }
    for (k = 0; k < 10; ++k) {
        unsigned depth;
        measure(k);
        depth = stack(tick) - stack(nothing);
        deepest = depth > deepest ? depth : deepest;
    }
    printf("%s: %.0f instructions per tick, at most %.0f; stack %u bytes\n", name, sum / TICKS,
           longest, deepest);
}

int main(void)
{
    double per_count;

    hardware_start_clock();
    per_count = 200000.0 / (double)(counts(loop) - counts(nothing));
    sh_parameters_default(&parameters);
    parameters.method = SH_METHOD_PAPER2011;
    printf("orders %d and %d\n", parameters.rls.n, parameters.rls.m);
    report("Paper2011", per_count);
    parameters.method = SH_METHOD_FILTERED_REGRESSION;
    report("FilteredRegression, all columns", per_count);
    remove_columns();
    report("FilteredRegression, few columns", per_count);
    printf("RAM: %u bytes: state %u, parameters %u, estimate %u\n",
           (unsigned)(sizeof estimator + sizeof parameters + sizeof estimate),
           (unsigned)sizeof estimator, (unsigned)sizeof parameters, (unsigned)sizeof estimate);
    return 0;
}
