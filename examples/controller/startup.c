/* Startup code and interrupt table for a Cortex-M with a floating-point unit. */
#include <stdint.h>

void stack_top(void); /* stack_top is not a function, but an address from mps2.ld */
void _start(void);    /* function of the C library that clears .bss, calls main and exit */
void SysTick_Handler(void);

/* Default handler for programs without interrupts. */
__attribute__((weak)) void SysTick_Handler(void)
{
}

static void reset(void)
{
    volatile uint32_t *const CPACR = (volatile uint32_t *)0xe000ed88;

    *CPACR = *CPACR | 0xfu << 20; /* the floating-point unit is off after a reset */
    __asm volatile("dsb\n\tisb");
    /* A program in flash memory would now copy .data to RAM. The emulator has already loaded .data into RAM. */
    _start();
}

/* Causes a second fault in the handler of a fault, so that the processor stops and the emulator prints a message. */
static void fault(void)
{
    __asm volatile("udf #0");
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    stack_top,
    reset,
    [2] = fault, /* handler of NMI and of hard, memory, bus and usage faults */
    [3] = fault,
    [4] = fault,
    [5] = fault,
    [6] = fault,
    [15] = SysTick_Handler, /* the others are not used */
};
