/* The functions of ud_factor.c that contracts.h replaces, with their contracts, for SH_MAX_N SH_MAX_M parameters.
 * Every array is as short as possible, and every loop is unrolled.
 * Behind each array is a guard, which the functions must not read or write.
 */
#include "anything.h"
#include "contracts.h"

void parameters(void)
{
    sh_ud_factor P, started;
    sh_real F[SH_MAX_PARAMETERS];

    sh_ud_factor_start(&started, SH_MAX_PARAMETERS, any_real());
    ANYTHING(P.D);
    ANYTHING(P.U);
    ANYTHING(F);
    P.least = any_real();
    P.size = SH_MAX_PARAMETERS;
    sh_ud_factor_project(&P, F);
    sh_ud_factor_update(&P, any_real());
    sh_ud_factor_variance(&P, F);
    //@ assert guards: !\initialized(&P.guard_D[0]) && !\initialized(&P.guard_U[0]);
    //@ assert guards: !\initialized(&P.work.guard_g[0]) && !\initialized(&P.work.guard_f[0]);
    //@ assert guards: !\initialized(&P.work.guard_rho[0]);
}
