/* An FMU from C, linked with its sources, under inputs that differ between variants. */
#ifndef SH_TEST_DRIVE_H
#define SH_TEST_DRIVE_H

#include "fmi2Functions.h"

/* Ends the program with status 1 and says why, unless the condition holds. */
void check(int condition, const char *what);

/* A new instance, initialised; messages go nowhere. */
fmi2Component start(void);

/* Step number k of 1 ms. */
void step(fmi2Component instance, int variant, long k);

/* Real outputs [size: at most 256]; returns how many there are. */
size_t get_outputs(fmi2Component instance, double *values);

#endif
