/* The functions that main.c needs from the hardware. Write these functions for yours. */
#ifndef HARDWARE_H
#define HARDWARE_H

#include <stdint.h>

#include "sigmahat.h"

/* Calls SysTick_Handler `rate` times per second from now on. */
void hardware_start_ticks(uint32_t rate);

/* Reads the encoders of motor and link, both behind the gear [rad], and the torque of the motor before its gear, from
 * its current [N.m].
 */
sh_measurement hardware_read(void);

/* Counts of the clock since this interrupt was due, and counts in one period. */
uint32_t hardware_elapsed(void);
uint32_t hardware_period(void);

/* For cost.c: a clock of 24 bits that counts down without interrupts. */
void hardware_start_clock(void);
uint32_t hardware_clock(void);

/* Sleeps until an interrupt. */
void hardware_sleep(void);

/* Between these two calls there are no interrupts. */
void hardware_disable_interrupts(void);
void hardware_enable_interrupts(void);

#endif
