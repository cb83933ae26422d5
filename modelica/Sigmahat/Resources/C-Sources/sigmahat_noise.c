/* Sigmahat.Plants.standardNormal: the noise of the FMUs. */
#ifndef SIGMAHAT_NOISE_C
#define SIGMAHAT_NOISE_C

#include "noise.c"

double sigmahat_standard_normal(int seed, int k, int channel)
{
    return sh_noise_normal(seed, (uint64_t)k, (unsigned)channel);
}

#endif
