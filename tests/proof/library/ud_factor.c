/* The functions of ud_factor.c that contracts.h stands for, for one number of parameters after the
 * other: every loop is unrolled. Their contracts are checked with their bodies.
 */
#include "anything.h"
#include "contracts.h"

static sh_ud_factor P;
static sh_real F[SH_MAX_ROWS];

static void of(int size)
{
    sh_ud_factor_start(&P, size, any_real());
    ANYTHING(P);
    ANYTHING(F);
    P.size = size;
    sh_ud_factor_project(&P, F);
    sh_ud_factor_update(&P, any_real());
    sh_ud_factor_variance(&P, F);
}

void sizes(void)
{
    int size;

    for (size = PROOF_FIRST; size <= PROOF_LAST; ++size) {
        of(size);
    }
    //@ assert reached: \true;
}
