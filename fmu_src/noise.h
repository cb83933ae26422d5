/* White Gaussian noise without a stored state: each sample depends only on the seed, on its number k and on its
 * channel. The noise is the same on every platform.
 */
#ifndef SH_NOISE_H
#define SH_NOISE_H

#include <stdint.h>

/* Returns sample k of a noise channel, a random number with standard normal distribution. Samples of different channels
 * or different seeds are independent. The seed and k may have any value.
 */
double sh_noise_normal(int seed, uint64_t k, unsigned channel);

#endif
