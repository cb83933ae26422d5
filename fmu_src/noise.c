#include "noise.h"

#include <math.h>

/* Returns the next 64 random bits of the generator splitmix64 by Steele, Lea and Flood, "Fast splittable
 * pseudorandom number generators", OOPSLA 2014.
 */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);

    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* Returns a uniform random number, the centre of one of 2^52 equal parts of (0, 1). It is never 0 or 1. */
static double uniform(uint64_t *state)
{
    return ((double)(next_bits(state) >> 12) + 0.5) / 4503599627370496.0;
}

double sh_noise_normal(int seed, uint64_t k, unsigned channel)
{
    uint64_t state = (uint64_t)seed;
    double u, x;

    /* Each combination of seed, channel and sample has its own initial state of the random generator. */
    state = next_bits(&state) + channel;
    state = next_bits(&state) + k;
    state = next_bits(&state);

    /* The method is the ratio of uniforms: Kinderman and Monahan, ACM Transactions on Mathematical Software 3 (1977).
     * The last bit of a logarithm depends on the platform. But the logarithm only decides whether a pair of random
     * numbers is accepted, and does not change the returned random number.
     */
    do {
        const double v = 1.7155277699214135 * (uniform(&state) - 0.5); /* sqrt(8/e) */
        u = uniform(&state);
        x = v / u;
    } while (x * x > -4.0 * log(u));
    return x;
}
