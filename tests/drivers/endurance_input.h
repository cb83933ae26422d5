/* Measurements for a run of any length, in double for any SH_REAL. */
#ifndef ENDURANCE_INPUT_H
#define ENDURANCE_INPUT_H

#include <stdint.h>

enum { INPUT_CYCLE = 100000 }; /* ticks after which the phases repeat */

enum { INPUT_COUNTS = 40000 }; /* of every encoder, per turn */

/* Rotating pointer: cos and sin of an angle that grows by the same amount every tick. */
typedef struct {
    double c, s, step_c, step_s;
} input_pointer;

/* The sample of one tick. */
typedef struct {
    double theta, q, theta_c, tau, tau_e_sensor;
    int modality; /* as sh_parameters.modality */
} input_sample;

typedef struct {
    input_pointer fast, slow, bend, twist, secondary;
    double torque; /* the huge one, in multiples of the usual one */
    uint64_t random;
    long tick;
    input_sample held; /* what the encoders show at rest */
} input_stream;

void input_start(input_stream *input, double torque);

/* The next sample: excitation, rest, a saturated encoder, a huge torque, changes of the modality, lost
 * samples, and then all of it again.
 */
input_sample input_next(input_stream *input);

#endif
