/* Direction in which a motor turns, from its encoder: what Coulomb friction acts against.
 *
 * The sign of a filtered velocity comes too late to stand beside other filtered
 * signals. Here it comes from the counts themselves: between two counts the sign
 * is that of the last one, until so much time has passed without a count that
 * the motor is slower than a given velocity and nobody knows the sign.
 * A reversal is placed between the last count one way and the first count the
 * other way as if the velocity were linear in time: an encoder edge that is
 * crossed both ways is crossed at the same time before and after.
 */
#ifndef SH_MOTION_SIGN_H
#define SH_MOTION_SIGN_H

#include "real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* State of the sign of one motor. */
typedef struct {
    sh_real position;  /* at the last change of position [rad] */
    sh_real change;    /* last change of position [rad], 0 before the first */
    sh_real direction; /* sign with the last change, -1..1 */
    sh_real waiting;   /* samples since the last change */
    sh_real given;     /* sum of the signs in these samples */
    sh_real sign;      /* mean sign of the velocity over the last sample, -1..1; at a reversal it
                          makes up for what was wrong before, and may be larger */
    sh_real unknown;   /* 0 if it is known, 1 if not, more if samples before were wrong as well */
} sh_motion_sign;

/* Starts at a position [rad]: nothing is known until it changes. */
void sh_motion_sign_start(sh_motion_sign *motion, sh_real position);

/* Takes the next position [rad].
 *
 * count  smallest change that the encoder can show [rad], >= 0
 * slow   velocity below which the sign is not trusted, times the sample period [rad], > 0
 */
void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow);

#ifdef __cplusplus
}
#endif
#endif
