/* The interface of main.c to the hardware. Implement the functions of this file for your own hardware. */
#ifndef HARDWARE_H
#define HARDWARE_H

#include <stdint.h>

#include "sigmahat.h"

/* Starts a timer that calls SysTick_Handler `rate` times per second. */
void hardware_start_ticks(uint32_t rate);

/* Reads the positions of motor and link after the gear [rad] from their encoders. Reads the torque of the motor before
 * its gear [N.m] from the motor current.
 */
sh_measurement hardware_read(void);

/* Two functions that return the clock counts since the current interrupt was due, and the counts of one period. */
uint32_t hardware_elapsed(void);
uint32_t hardware_period(void);

/* Two functions that start and read a clock for cost.c, which has 24 bits and counts down without interrupts. */
void hardware_start_clock(void);
uint32_t hardware_clock(void);

/* Sleeps until the next interrupt. */
void hardware_sleep(void);

/* Between the calls of these two functions the processor handles no interrupts. */
void hardware_disable_interrupts(void);
void hardware_enable_interrupts(void);

#endif
