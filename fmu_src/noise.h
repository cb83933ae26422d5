/* White Gaussian noise without a state: sample k of a channel depends only on the seed, on k and on
 * the channel. The noise is the same on every platform.
 */
#ifndef SH_NOISE_H
#define SH_NOISE_H

#include <stdint.h>

/* Standard normal number k of a channel. Different channels and different seeds give independent
 * numbers. Any seed and any k are allowed.
 */
double sh_noise_normal(int seed, uint64_t k, unsigned channel);

#endif
