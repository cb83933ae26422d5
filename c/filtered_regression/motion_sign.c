/* Direction in which a motor turns, from its encoder: Coulomb friction acts against this direction (F7). The sign of a filtered velocity would be late.
 */
#include "real_math.h"
#include "regression.h"

void sh_motion_sign_start(sh_motion_sign *motion, sh_real position)
{
    const sh_motion_sign start = {.position = position, .unknown = 1};

    *motion = start;
}

void sh_motion_sign_step(sh_motion_sign *motion, sh_real position, sh_real count, sh_real slow)
{
    const sh_real change = position - motion->position;
    const sh_real before = motion->change;
    const sh_real run = motion->waiting + 1; /* samples since the last change */
    const int moved = sh_fabs(change) >= count / 2 && sh_fabs(change) > 0;
    /* Without a new encoder count, the velocity is at most one count divided by the time since the last count. */
    const sh_real velocity = sh_fmax(moved ? sh_fabs(change) : 0, count) / run;
    const sh_real way = change > 0 ? 1 : -1;

    if (!moved) {
        motion->waiting = run;
        motion->unknown = velocity < slow || sh_fabs(motion->direction) < 1 ? 1 : 0;
        motion->sign = motion->unknown > 0 ? 0 : motion->direction;
        motion->given += motion->sign;
        return;
    }
    motion->direction = way * sh_fmin(velocity / slow, 1);
    motion->sign = motion->direction;
    motion->unknown = velocity < slow || before == 0 ? 1 : 0;
    if (change * before < 0) {
        /* The motor reversed in the middle between two counts: the sign corrects the signs that were reported since the
         * last count. Without the correction, the error of a joint with Coulomb friction is up to twice as large.
         */
        motion->sign -= motion->given;
        if (sh_fmin(sh_fabs(change), sh_fabs(before)) < (sh_real)1.5 * count) {
            motion->unknown = 1 + sh_fabs(motion->given);
        }
    }
    motion->position = position;
    motion->change = change;
    motion->given = 0;
    motion->waiting = 0;
}
