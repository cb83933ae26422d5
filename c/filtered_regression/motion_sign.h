/* Direction in which a motor turns, from its encoder: Coulomb friction acts against it (point 3,
 * detail 3).
 *
 * The sign of a filtered velocity would be late compared with the other filtered signals. So the
 * sign is taken from the counts of the encoder. Between two counts it is the sign of the last one.
 * It becomes unknown when no count was received for so long that the motor must be slower than a
 * given velocity.
 *
 * At a reversal, the last count in one direction and the first count in the other direction are at
 * the same edge of the encoder. The motor passes this edge at the same speed both times, if its
 * acceleration is constant. So the reversal is taken to be in the middle between the two counts.
 */
#ifndef SH_MOTION_SIGN_H
#define SH_MOTION_SIGN_H

#include "sigmahat.h"

/* Starts at a position [rad]: the sign is unknown until the position changes. */
void sh_motion_sign_start(sh_motion_sign *motion, sh_real position);

/* Takes the next position [rad].
 *
 * count  smallest change that the encoder can show [rad], >= 0
 * slow   velocity below which the sign counts as unknown, times the sample period [rad], > 0
 */
void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow);

#endif
