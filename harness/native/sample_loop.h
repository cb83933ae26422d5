/* The loop over the samples of a co-simulation, for any FMUs for FMI 2.0.
 *
 * The caller loads and starts the FMUs, and gives a list of calls. For each sample, all calls are made in their
 * order. A value goes from one FMU to another by a get and a set that use the same memory.
 */
#ifndef SH_SAMPLE_LOOP_H
#define SH_SAMPLE_LOOP_H

#include <stddef.h>

#include "export.h"
#include "fmi2FunctionTypes.h"

/* The FMI function of a call, which determines the contents of its rows. */
enum {
    SH_CALL_SET_REAL = 1, /* fmi2Real, one per reference */
    SH_CALL_SET_SLOPES,   /* the same: first derivatives of the inputs */
    SH_CALL_DO_STEP,      /* two fmi2Real: communication point and step [s] */
    SH_CALL_GET_REAL,     /* fmi2Real, one per reference */
    SH_CALL_GET_INTEGER   /* fmi2Integer or fmi2Boolean, one per reference */
};

/* One call for every sample. */
typedef struct {
    int kind; /* SH_CALL_* */
    fmi2Component component;
    void (*function)(void);               /* that FMI function of the FMU */
    const fmi2ValueReference *references; /* [size: count] */
    size_t count;
    const fmi2Integer *orders; /* of the derivatives, all 1 [size: count]; for SH_CALL_SET_SLOPES */
    char *rows;                /* the row of sample k is at rows + k * stride */
    size_t stride;             /* [bytes]; 0: the same row for every sample */
} sh_call;

/* Makes the calls for the samples first to end - 1.
 *
 * Returns `count`, or the place of the first call whose status was above fmi2Warning: it ends the
 * loop.
 */
SH_EXPORT size_t sh_sample_loop(const sh_call *calls, size_t count, size_t first, size_t end);

/* A number that is raised with every change of a function or struct of this library that Python
 * knows. The same number is in harness/sigmahat/fmi/native.py.
 */
SH_EXPORT int sh_native_interface(void);

#endif
