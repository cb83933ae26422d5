/* Included before everything else, compiles the estimator with another type instead of double:
 * long double, or with HIGH_PRECISION_QUAD gcc's __float128. Constants stay the doubles they are.
 */
#ifndef HIGH_PRECISION_H
#define HIGH_PRECISION_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "endurance_input.h"

#ifdef HIGH_PRECISION_QUAD
#include <math.h>
#include <quadmath.h>
#undef isfinite
#define isfinite finiteq
#define fabs fabsq
#define sqrt sqrtq
#define exp expq
#define sin sinq
#define fmin fminq
#define fmax fmaxq
#define double __float128
#else
#include <tgmath.h>
#define double long double
#endif

#endif
