/* An FMU driven from C and linked with its sources, in any version of FMI. Its inputs depend on the
 * variant.
 */
#ifndef SH_TEST_DRIVE_H
#define SH_TEST_DRIVE_H

#include <stddef.h>

/* A new instance, initialised; its messages are ignored. */
void *start(void);

/* Makes step number k, of 1 ms. */
void step(void *instance, int variant, long k);

/* Real outputs [size: at most 256]; returns how many there are. */
size_t get_outputs(void *instance, double *values);

#endif
