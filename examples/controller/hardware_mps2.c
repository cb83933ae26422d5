/* Arm's board MPS2 (in QEMU: mps2-an386, mps2-an500), with a simulated joint. */
#include "hardware.h"

#include <math.h>

/* The timer SysTick of the processor, which counts down. */
typedef struct {
    uint32_t control, reload, value;
} timer;
static volatile timer *const SYSTICK = (volatile timer *)0xe000e010;

enum { CLOCK = 25000000 }; /* clock of the processor [Hz] */

static uint32_t samples;

void hardware_start_ticks(uint32_t rate)
{
    SYSTICK->reload = CLOCK / rate - 1;
    SYSTICK->value = 0;
    SYSTICK->control = 7; /* on, with interrupt, clock of the processor */
}

/* Interrupt control: bit 26 says that the next interrupt of SysTick is waiting already. */
static volatile uint32_t *const ICSR = (volatile uint32_t *)0xe000ed04;

uint32_t hardware_elapsed(void)
{
    const uint32_t periods = *ICSR >> 26 & 1u;

    return periods * hardware_period() + SYSTICK->reload - SYSTICK->value;
}

uint32_t hardware_period(void)
{
    return SYSTICK->reload + 1;
}

void hardware_start_clock(void)
{
    SYSTICK->reload = 0xffffff;
    SYSTICK->value = 0;
    SYSTICK->control = 5; /* on, without interrupt */
}

uint32_t hardware_clock(void)
{
    return SYSTICK->value;
}

void hardware_sleep(void)
{
    __asm volatile("wfi");
}

void hardware_disable_interrupts(void)
{
    __asm volatile("cpsid i" ::: "memory");
}

void hardware_enable_interrupts(void)
{
    __asm volatile("cpsie i" ::: "memory");
}

/* The motor has the data of the start values, and swings by 0.5 rad at 1 Hz. The transmission has 150 N.m/rad. The
 * motor equation (3) of the paper gives the torque.
 */
sh_measurement hardware_read(void)
{
    const sh_real count = (sh_real)(6.283185307179586 / 40000); /* of an encoder [rad] */
    const float w = 6.28318531f, B = 2.3e-5f, D_theta = 1e-3f, gamma = 50.0f, sigma = 150.0f;
    const float per_rad = 40000.0f / 6.28318531f;
    const float phase = w * (float)(samples % 1000) / 1000.0f;
    const float theta = 0.5f * sinf(phase), phi = 0.02f * sinf(phase);
    const float torque =
        gamma * (D_theta * 0.5f * w * cosf(phase) - B * w * w * theta) - sigma * phi / gamma;
    sh_measurement z = {0};

    z.theta = count * (sh_real)lroundf(theta * per_rad);
    z.q = count * (sh_real)lroundf((theta + phi) * per_rad);
    z.tau = (sh_real)torque;
    ++samples;
    return z;
}
