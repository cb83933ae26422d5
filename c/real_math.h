/* Functions of <math.h> for the type sh_real, and limits that depend on the range of this type.
 *
 * <tgmath.h> cannot be used, because of newlib, the C library of most controllers. The <tgmath.h> of newlib refers to
 * complex functions that newlib does not have.
 */
#ifndef SH_REAL_MATH_H
#define SH_REAL_MATH_H

#include <math.h>

#include "sigmahat.h"

#define SH_FOR_double(of_double, of_float) of_double
#define SH_FOR_float(of_double, of_float) of_float
#define SH_FOR_TYPE(type, of_double, of_float) SH_FOR_##type(of_double, of_float)
#define SH_FOR(type, of_double, of_float) SH_FOR_TYPE(type, of_double, of_float)

#define sh_cos SH_FOR(SH_REAL, cos, cosf)
#define sh_exp SH_FOR(SH_REAL, exp, expf)
#define sh_fabs SH_FOR(SH_REAL, fabs, fabsf)
#define sh_floor SH_FOR(SH_REAL, floor, floorf)
#define sh_fmax SH_FOR(SH_REAL, fmax, fmaxf)
#define sh_fmin SH_FOR(SH_REAL, fmin, fminf)
#define sh_log SH_FOR(SH_REAL, log, logf)
#define sh_sin SH_FOR(SH_REAL, sin, sinf)
#define sh_sqrt SH_FOR(SH_REAL, sqrt, sqrtf)

static inline sh_real sh_square(sh_real x)
{
    return x * x;
}

#define SH_PI 3.14159265358979323846

/* A large number whose product with any practical number does not overflow; in double precision also its square. */
#define SH_LARGE SH_FOR(SH_REAL, 1e150, 1e30f)

/* Limit of an output that would overflow. */
#define SH_LARGEST_OUTPUT SH_FOR(SH_REAL, 1e300, 1e38f)

/* x within -limit..limit; limit if x is not a number */
static inline sh_real sh_limited(sh_real x, sh_real limit)
{
    if (x < -limit) {
        return -limit;
    }
    return x <= limit ? x : limit;
}

/* Std deviation of a variance; infinite if the variance overflowed or is not a number. */
static inline sh_real sh_std_deviation(sh_real variance)
{
    return variance >= 0 ? sh_sqrt(variance) : INFINITY;
}

#endif
