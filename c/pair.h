/* Arithmetic with pairs: two numbers that are neighbours in memory and are processed together.
 *
 * Compilers use vector instructions for loops over long arrays. For the short loops of the recursion, vector
 * instructions that a compiler chooses are often missing or slow. The loops therefore use the pairs of this header
 * explicitly. Where the processor has registers for two doubles, gcc and clang compute a pair in one instruction. The
 * plain C below has the same results to the last digit.
 */
#ifndef SH_PAIR_H
#define SH_PAIR_H

#include <string.h>

#include "real_math.h"

#if SH_FOR(SH_REAL, 1, 0) && defined __GNUC__ && (defined __SSE2__ || defined __aarch64__)

typedef sh_real sh_pair __attribute__((vector_size(2 * sizeof(sh_real))));

static inline sh_pair sh_pair_of(sh_real first, sh_real second)
{
    const sh_pair pair = {first, second};

    return pair;
}

static inline sh_pair sh_pair_add(sh_pair a, sh_pair b)
{
    return a + b;
}

static inline sh_pair sh_pair_subtract(sh_pair a, sh_pair b)
{
    return a - b;
}

static inline sh_pair sh_pair_multiply(sh_pair a, sh_pair b)
{
    return a * b;
}

static inline sh_real sh_pair_sum(sh_pair a)
{
    return a[0] + a[1];
}

static inline sh_pair sh_pair_load(const sh_real *from)
{
    sh_pair pair;

    (void)memcpy(&pair, from, sizeof pair);
    return pair;
}

static inline void sh_pair_store(sh_real *to, sh_pair pair)
{
    (void)memcpy(to, &pair, sizeof pair);
}

#else

typedef struct {
    sh_real first, second;
} sh_pair;

static inline sh_pair sh_pair_of(sh_real first, sh_real second)
{
    const sh_pair pair = {first, second};

    return pair;
}

static inline sh_pair sh_pair_add(sh_pair a, sh_pair b)
{
    return sh_pair_of(a.first + b.first, a.second + b.second);
}

static inline sh_pair sh_pair_subtract(sh_pair a, sh_pair b)
{
    return sh_pair_of(a.first - b.first, a.second - b.second);
}

static inline sh_pair sh_pair_multiply(sh_pair a, sh_pair b)
{
    return sh_pair_of(a.first * b.first, a.second * b.second);
}

static inline sh_real sh_pair_sum(sh_pair a)
{
    return a.first + a.second;
}

static inline sh_pair sh_pair_load(const sh_real *from)
{
    return sh_pair_of(from[0], from[1]);
}

static inline void sh_pair_store(sh_real *to, sh_pair pair)
{
    to[0] = pair.first;
    to[1] = pair.second;
}

#endif

static inline sh_pair sh_pair_both(sh_real value)
{
    return sh_pair_of(value, value);
}

/* ab = a' b and ac = a' c for a, b, c [size: size]. Even and odd entries have separate, parallel sums. */
static inline void sh_scalar_products(const sh_real *a, const sh_real *b, const sh_real *c,
                                      int size, sh_real *ab, sh_real *ac)
{
    sh_pair of_b = sh_pair_both(0), of_c = of_b;
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
    *ab = sh_pair_sum(of_b);
    *ac = sh_pair_sum(of_c);
}

#endif
