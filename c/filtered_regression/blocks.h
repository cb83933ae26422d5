/* The misfit of the model: how much larger the slow part of the prediction error is than its noise.
 *
 * The samples of 50 ms make a block, a weighted mean of their rows. The window of the mean,
 * h = 16 x^2 (1 - x)^2 with x from 0 to 1, is smooth, so that little of the rounding of theta'' is
 * left. The variance of the noise of a block is known: of the noise of the torque, and of the
 * rounding and jitter of theta, the share that is left by H, or s^2 H, and by the window. With N
 * blocks, and p parameters, whose errors are the more contained in the estimate the fewer blocks
 * there are, the misfit squared is
 *
 *     q = (sum of the squares of the blocks' errors over their variances) / (N - p / 2) .
 *
 * A misfit is a function of the state. It repeats with the motion, and so it does not average out
 * as noise does. Above the threshold t = 1 + 3 sqrt(2 / N), all variances grow by the factor
 *
 *     kappa^2 = max(q, 1 + (q - t) max(1, N / 5)) ,
 *
 * that is, as if five blocks were one. It acts on past samples too, so that the priors bind again.
 */
#ifndef SH_BLOCKS_H
#define SH_BLOCKS_H

#include "sigmahat.h"

/* Starts, after the filters and the columns. */
void sh_blocks_start(sh_regression_state *state);

/* Takes a sample that the estimate used.
 *
 * x     [size: state->size + SH_SIDES] its row
 * w     its weight, one over its variance [1/(N.m)2]
 * last  factor by which errors that last increase its variance, >= 1: samples with the same error
 *       count as fewer
 */
void sh_blocks_take(sh_regression_state *state, const sh_parameters *p, const sh_real *x, sh_real w,
                    sh_real last);

/* Leaves out the samples of the present block: they are not in sequence with the next one. */
void sh_blocks_interrupt(sh_blocks *blocks, int size);

/* Multiplies the weights of all blocks by keep, 0..1; not those of the recent ones. */
void sh_blocks_fade(sh_blocks *blocks, sh_real keep);

/* Sets state->q and state->variance_factor by the estimate beta. */
void sh_blocks_judge(sh_regression_state *state, const sh_parameters *p);

/* Sum of squares that is beyond chance for N blocks with no misfit: N (1 + 3 sqrt(2 / N)). */
sh_real sh_blocks_threshold(sh_real N);

/* Factor of the variances above which the data contradict the model. */
#define SH_CONTRADICTION ((sh_real)1.5)

#define SH_BLOCKS_FIRST ((sh_real)20) /* number of blocks below which nothing is judged */

#endif
