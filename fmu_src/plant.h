/* Variables and state of a plant FMU. Every plant whose equations are generated as C code uses this struct. */
#ifndef SH_PLANT_H
#define SH_PLANT_H

#include <stdint.h>

#include "plant_functions.h"

/* The arrays have the order of the variables in the model description. */
typedef struct {
    double p[SH_PLANT_PARAMETERS];
    double u[SH_PLANT_INPUTS];
    double du[SH_PLANT_INPUTS]; /* time derivatives of u */
    /* Amplitude and frequency [Hz] of a sine that is added to an input. An amplitude of 0 switches the sine off. */
    double amplitude[SH_PLANT_INPUTS], frequency[SH_PLANT_INPUTS];
    double started; /* start time [s] */
    double y[SH_PLANT_OUTPUTS];
    double x[SH_PLANT_STATES];
    double h;            /* internal step length that the integrator tries first [s] */
    double samplePeriod; /* sample period of the noise [s]; 0 for a plant without noise */
    double since;        /* age of the noise sample in the outputs y [sample periods] */
    uint64_t sample;     /* number of the noise sample in the outputs y */
    int seed;            /* of the noise */
} sh_plant;

#endif
