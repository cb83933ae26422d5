/* The functions of information.c that contracts.h stands for, for one number of columns after the
 * other: every loop is unrolled. Their contracts are checked with their bodies.
 */
#include "anything.h"
#include "contracts.h"

static sh_information a, b;
static sh_real x[SH_MAX_ENTRIES], v[SH_MAX_COLUMNS], c[SH_MAX_COLUMNS];

static void any_information(int size)
{
    ANYTHING(a);
    ANYTHING(x);
    ANYTHING(v);
    ANYTHING(c);
    a.size = size;
}

static void of(int size)
{
    int i;

    any_information(size);
    sh_information_take(&a, x, any_real());
    sh_information_project(&a, c, v);
    sh_information_squares(&a, c);
    sh_information_fade(&a, any_real(), any_real());
    sh_information_walk(&a, v, any_real(), x);
    sh_information_solve(&a, SH_SIDE_GAIN, v);
    sh_information_solve(&a, SH_SIDE_Y, v);
    sh_information_side(&a, SH_SIDE_GAIN, v);
    sh_information_side(&a, SH_SIDE_Y, v);
    for (i = 0; i < size; ++i) {
        sh_information_sample(&a, i, x);
    }
    sh_information_last(&a);
    sh_information_copy(&b, &a);
    sh_information_start(&b, size, any_real());
}

void sizes(void)
{
    int size;

    for (size = PROOF_FIRST; size <= PROOF_LAST; ++size) {
        of(size);
    }
    //@ assert reached: \true;
}

/* A row of a triangle with any sample whose numbers are finite, also one that is removed, w < 0: the
 * entry of D stays positive.
 */
void positive(void)
{
    any_information(1);
    a.D[0] = (sh_real)Frama_C_float_interval(1e-38f, 1e37f);
    x[0] = (sh_real)Frama_C_float_interval(-1e9f, 1e9f);
    sh_information_take(&a, x, (sh_real)Frama_C_float_interval(-1e18f, 1e18f));
    //@ assert positive: a.D[0] > 0;
}
