#include "noise.h"

#include <math.h>

/* The next 64 random bits: splitmix64, Steele, Lea, Flood, "Fast splittable
 * pseudorandom number generators", OOPSLA 2014.
 */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);

    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* Uniform over the centres of 2^52 equal parts of (0, 1): never 0 or 1, and exact. */
static double uniform(uint64_t *state)
{
    return ((double)(next_bits(state) >> 12) + 0.5) / 4503599627370496.0;
}

double sh_noise_normal(int seed, uint64_t k, unsigned channel)
{
    uint64_t state = (uint64_t)seed;
    double u, x;

    /* Every seed, channel and sample has its own initial state. */
    state = next_bits(&state) + channel;
    state = next_bits(&state) + k;
    state = next_bits(&state);

    /* Ratio of uniforms: Kinderman, Monahan, ACM Trans. Math. Softw. 3 (1977). The last bit of the logarithm depends
     * on the platform. But the logarithm only decides whether a pair is accepted, and has no effect on the value.
     */
    do {
        const double v = 1.7155277699214135 * (uniform(&state) - 0.5); /* sqrt(8/e) */
        u = uniform(&state);
        x = v / u;
    } while (x * x > -4.0 * log(u));
    return x;
}
