/* The scalar product, once for all blocks. */
#ifndef SH_SCALAR_PRODUCT_H
#define SH_SCALAR_PRODUCT_H

#include "sigmahat.h"

/* a' b for a, b [size: size]. Even and odd entries have a sum each: neither waits for the other. */
static inline sh_real sh_dot(const sh_real *a, const sh_real *b, int size)
{
    sh_real even = 0, odd = 0;
    int i;

    for (i = 0; i + 1 < size; i += 2) {
        even += a[i] * b[i];
        odd += a[i + 1] * b[i + 1];
    }
    if (i < size)
        even += a[i] * b[i];
    return even + odd;
}

#endif
