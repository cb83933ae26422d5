/* Two scalar products in one pass. */
#ifndef SH_SCALAR_PRODUCT_H
#define SH_SCALAR_PRODUCT_H

#include "sigmahat.h"

/* ab = a' b and ac = a' c for a, b, c [size: size]. Even and odd entries have a sum each, so that
 * one does not wait for the other.
 */
static inline void sh_scalar_products(const sh_real *a, const sh_real *b, const sh_real *c,
                                      int size, sh_real *ab, sh_real *ac)
{
    sh_real of_b[2] = {0, 0}, of_c[2] = {0, 0};
    int i;

    for (i = 0; i + 1 < size; i += 2) {
        of_b[0] += a[i] * b[i];
        of_b[1] += a[i + 1] * b[i + 1];
        of_c[0] += a[i] * c[i];
        of_c[1] += a[i + 1] * c[i + 1];
    }
    if (i < size) {
        of_b[0] += a[i] * b[i];
        of_c[0] += a[i] * c[i];
    }
    *ab = of_b[0] + of_b[1];
    *ac = of_c[0] + of_c[1];
}

#endif
