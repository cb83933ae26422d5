/* Functions of <math.h> for the type of real.h, and what depends on its range.
 *
 * <tgmath.h> would do, but the one of newlib, the C library of most controllers, lacks the
 * complex functions that it refers to.
 */
#ifndef SH_REAL_MATH_H
#define SH_REAL_MATH_H

#include <math.h>

#include "real.h"

#define SH_FOR_double(of_double, of_float) of_double
#define SH_FOR_float(of_double, of_float) of_float
#define SH_FOR_TYPE(type, of_double, of_float) SH_FOR_##type(of_double, of_float)
#define SH_FOR(type, of_double, of_float) SH_FOR_TYPE(type, of_double, of_float)

#define sh_exp SH_FOR(SH_REAL, exp, expf)
#define sh_fabs SH_FOR(SH_REAL, fabs, fabsf)
#define sh_fmax SH_FOR(SH_REAL, fmax, fmaxf)
#define sh_fmin SH_FOR(SH_REAL, fmin, fminf)
#define sh_sin SH_FOR(SH_REAL, sin, sinf)
#define sh_sqrt SH_FOR(SH_REAL, sqrt, sqrtf)

/* A number whose square, or product with any sensible one, is far from overflow. */
#define SH_LARGE SH_FOR(SH_REAL, 1e150, 1e30f)

#endif
