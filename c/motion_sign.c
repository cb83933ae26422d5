#include "motion_sign.h"

#include <math.h>

void sh_motion_sign_start(sh_motion_sign *motion, double position)
{
    motion->position = position;
    motion->change = 0.0;
    motion->direction = 0.0;
    motion->given = 0.0;
    motion->waiting = 0.0;
    motion->sign = 0.0;
    motion->unknown = 1.0;
}

void sh_motion_sign_step(sh_motion_sign *motion, double position, double count, double slow)
{
    const double change = position - motion->position;
    const double before = motion->change;
    const double run = motion->waiting + 1.0; /* samples since the last change */
    const int moved = fabs(change) >= count / 2.0 && fabs(change) > 0.0;
    /* All that is known before a count comes: the motor is not faster than one in this time. */
    const double velocity = fmax(moved ? fabs(change) : 0.0, count) / run;
    const double way = change > 0.0 ? 1.0 : -1.0;

    if (!moved) {
        motion->waiting = run;
        motion->unknown = velocity < slow || fabs(motion->direction) < 1.0 ? 1.0 : 0.0;
        motion->sign = motion->unknown > 0.0 ? 0.0 : motion->direction;
        motion->given += motion->sign;
        return;
    }
    motion->direction = way * fmin(velocity / slow, 1.0);
    motion->sign = motion->direction;
    motion->unknown = velocity < slow || before == 0.0 ? 1.0 : 0.0;
    if (change * before < 0.0) {
        /* The motor turned in the middle of the run, and what was given since the last count is
         * taken back; or, if it is fast, where its velocity crossed zero.
         */
        if (run > 1.0)
            motion->sign -= motion->given;
        else
            motion->sign = way * 2.0 * fabs(change) / (fabs(change) + fabs(before));
        if (fmin(fabs(change), fabs(before)) < 1.5 * count)
            motion->unknown = 1.0 + fabs(motion->given);
    }
    motion->position = position;
    motion->change = change;
    motion->given = 0.0;
    motion->waiting = 0.0;
}
