/* Two scalar products in one pass. */
#ifndef SH_SCALAR_PRODUCT_H
#define SH_SCALAR_PRODUCT_H

#include "pair.h"

/* ab = a' b and ac = a' c for a, b, c [size: size]. Even and odd entries have a sum each, so that
 * one does not wait for the other.
 */
static inline void sh_scalar_products(const sh_real *a, const sh_real *b, const sh_real *c,
                                      int size, sh_real *ab, sh_real *ac)
{
    sh_pair of_b = sh_pair_both(0), of_c = of_b;
    sh_real sums[2];
    int i;

    for (i = 0; i + 1 < size; i += 2) {
        const sh_pair a_i = sh_pair_load(a + i);

        of_b = sh_pair_add(of_b, sh_pair_multiply(a_i, sh_pair_load(b + i)));
        of_c = sh_pair_add(of_c, sh_pair_multiply(a_i, sh_pair_load(c + i)));
    }
    if (i < size) {
        const sh_pair a_i = sh_pair_of(a[i], 0);

        of_b = sh_pair_add(of_b, sh_pair_multiply(a_i, sh_pair_of(b[i], 0)));
        of_c = sh_pair_add(of_c, sh_pair_multiply(a_i, sh_pair_of(c[i], 0)));
    }
    sh_pair_store(sums, sh_pair_sums(of_b, of_c));
    *ab = sums[0];
    *ac = sums[1];
}

#endif
