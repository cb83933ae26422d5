/* Measurements for a run without end, in double whatever SH_REAL is. */
#ifndef ENDURANCE_INPUT_H
#define ENDURANCE_INPUT_H

#include <stdint.h>

enum { INPUT_CYCLE = 100000 }; /* ticks after which the phases come again */

enum { INPUT_COUNTS = 40000 }; /* of every encoder, in a turn */

/* Rotating pointer: cos and sin of an angle that grows by the same amount every tick. */
typedef struct {
    double c, s, step_c, step_s;
} input_pointer;

/* What the joint does in a tick. */
typedef struct {
    double theta, q, theta_c, tau, tau_e_sensor;
    int modality; /* as sh_parameters.modality */
} input_sample;

typedef struct {
    input_pointer fast, slow, bend, twist, secondary;
    double torque; /* huge, times the usual */
    uint64_t random;
    long tick;
    input_sample held; /* what the encoders show while nothing moves */
} input_stream;

void input_start(input_stream *input, double torque);

/* The next sample: excitation, rest, an encoder at its stop, a huge torque, changing
 * modality, lost samples, and from the start again.
 */
input_sample input_next(input_stream *input);

#endif
