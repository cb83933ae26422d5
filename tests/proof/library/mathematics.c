/* Two functions of <math.h> for which the analyser has no body: C99, 7.12.12. */
#include <__fc_builtin.h>

#define SMALLER_AND_LARGER(real, smaller, larger)                                                  \
    real smaller(real x, real y)                                                                   \
    {                                                                                              \
        if (x < y)                                                                                 \
            return x;                                                                              \
        if (x >= y)                                                                                \
            return y;                                                                              \
        return Frama_C_nondet(0, 1) ? x : y; /* one is not a number */                             \
    }                                                                                              \
    real larger(real x, real y)                                                                    \
    {                                                                                              \
        if (x > y)                                                                                 \
            return x;                                                                              \
        if (x <= y)                                                                                \
            return y;                                                                              \
        return Frama_C_nondet(0, 1) ? x : y;                                                       \
    }

SMALLER_AND_LARGER(double, fmin, fmax)
SMALLER_AND_LARGER(float, fminf, fmaxf)
