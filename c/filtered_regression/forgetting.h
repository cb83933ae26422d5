/* Data that no longer hold: forgetting, and parameters that change. */
#ifndef SH_FORGETTING_H
#define SH_FORGETTING_H

#include "sigmahat.h"

/* Forgets, and lets the curve change, in `time` [s] since the last call.
 *
 * The time of forgetting is that of the blocks since then, of which those with the same error count
 * as fewer (blocks.h): while a joint rests, nothing is learned, and so nothing is forgotten.
 *
 * Data are forgotten only while they contradict the model: then everything fades with the time
 * constant regression.memory. The misfit is that of the data that remain, so forgetting ends by itself
 * when the contradicting data are gone, and data that agree are never forgotten. If the recent data
 * agree with the model by themselves, then something has changed, and the older data fade five times
 * as fast.
 *
 * The curve of the torque may change by regression.drift, along the columns of the last sample: what
 * is not excited is not forgotten.
 *
 * x  [size: state->size] row of the last sample
 */
void sh_forgetting_step(sh_regression_state *state, const sh_parameters *p, const sh_real *x,
                        sh_real time);

/* Lets friction change as a random walk, if the blocks contradict each other clearly less with it.
 */
void sh_forgetting_of_friction(sh_regression_state *state, sh_real time);

#endif
