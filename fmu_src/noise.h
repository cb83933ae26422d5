/* White Gaussian noise without a state: sample k of a channel is a function of the
 * seed, k and the channel alone, the same on every platform.
 */
#ifndef SH_NOISE_H
#define SH_NOISE_H

#include <stdint.h>

/* Standard normal number k of a channel. Channels, and seeds, are independent of
 * each other. Any seed and any k are allowed.
 */
double sh_noise_normal(int seed, uint64_t k, unsigned channel);

#endif
