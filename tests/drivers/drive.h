/* An FMU driven from C and linked with its sources. Its inputs depend on the variant. */
#ifndef SH_TEST_DRIVE_H
#define SH_TEST_DRIVE_H

#include "fmi2Functions.h"

/* If the condition is false, prints `what` and ends the program with status 1. */
void check(int condition, const char *what);

/* A new instance, initialised; its messages are ignored. */
fmi2Component start(void);

/* Makes step number k, of 1 ms. */
void step(fmi2Component instance, int variant, long k);

/* Real outputs [size: at most 256]; returns how many there are. */
size_t get_outputs(fmi2Component instance, double *values);

#endif
