/* Measurements for a run without end, the same to the last bit in every build. */
#ifndef ENDURANCE_INPUT_H
#define ENDURANCE_INPUT_H

#include <stdint.h>

/* Stay what they are where high_precision.h makes double something else. */
typedef double input_real;
typedef long double printed_real;

enum { INPUT_CYCLE = 100000 }; /* ticks after which the phases come again */

/* Resolution of the encoders [rad]. As powers of two they leave no rounding in a position or in
 * the difference of two, so that comparisons in the estimator come out the same in every precision.
 */
#define INPUT_COUNT (1.0 / 8192.0)
#define INPUT_COUNT_C (1.0 / 256.0)

/* Rotating pointer: cos and sin of an angle that grows by the same amount every tick. */
typedef struct {
    input_real c, s, step_c, step_s;
} input_pointer;

/* What the joint does in a tick. */
typedef struct {
    input_real theta, q, theta_c, tau, tau_e_sensor;
    int modality; /* as sh_parameters.modality */
} input_sample;

typedef struct {
    input_pointer fast, slow, bend, twist, secondary;
    uint64_t random;
    long tick;
    input_sample held; /* what the encoders show while nothing moves */
} input_stream;

void input_start(input_stream *input);

/* The next sample: excitation, rest, an encoder at its stop, torque of up to 1e6 N.m, changing
 * modality, lost samples, and from the start again.
 */
input_sample input_next(input_stream *input);

#endif
