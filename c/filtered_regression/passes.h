/* Passes: how the misfit, and the choice of columns, act on past samples in bounded time.
 *
 * The data of all samples are one triangular matrix of n rows. A row of it, with its weight, is a
 * sample for another one. So a new posterior is built beside the present one: in every second tick
 * it takes one row of a copy of the data, weighted by the misfit, and every new sample. After n rows
 * it replaces the present one. No tick takes more than O(n^2).
 *
 * Every second pass is a trial of a group of columns, whose result is not used: with its columns at
 * the end, their entries of D and z give the gain of the logarithm of the evidence,
 * (D z^2 - ln D) / 2 for each. With N blocks, the group is used above 3 + 0.05 N, and no longer below
 * 0.025 N.
 */
#ifndef SH_PASSES_H
#define SH_PASSES_H

#include "sigmahat.h"

/* Begins the first pass. */
void sh_passes_start(sh_regression_state *state, const sh_parameters *p);

/* Takes a sample into the next posterior, and advances the pass in every second call.
 *
 * x  [size: state->size + SH_SIDES] row of the sample; used as memory
 * w  weight of the sample [1/(N.m)2]
 */
void sh_passes_step(sh_regression_state *state, const sh_parameters *p, sh_real *x, sh_real w);

#endif
