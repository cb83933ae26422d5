/* The model of a plant FMU, for any plant whose equations were generated to C. */
#ifndef SH_PLANT_H
#define SH_PLANT_H

#include <stdint.h>

#include "plant_functions.h"

/* Arrays are in the order of the model description. */
typedef struct {
    double p[SH_PLANT_PARAMETERS];
    double u[SH_PLANT_INPUTS];
    double du[SH_PLANT_INPUTS]; /* time derivatives of u */
    /* A sine that is added to an input: amplitude, 0 for none, and frequency [Hz]. */
    double amplitude[SH_PLANT_INPUTS], frequency[SH_PLANT_INPUTS];
    double started; /* start time [s] */
    double y[SH_PLANT_OUTPUTS];
    double x[SH_PLANT_STATES];
    double h;            /* internal step that is short enough for the motion [s] */
    double samplePeriod; /* period of the noise [s]; 0 for a plant without noise */
    double since;        /* age of the noise sample in y, in periods */
    uint64_t sample;     /* number of the noise sample in y */
    int seed;            /* seed of the noise */
} sh_plant;

#endif
