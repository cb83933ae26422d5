/* The functions of least_squares.c that contracts.h replaces, with their contracts, for SH_MAX_N SH_MAX_M parameters.
 * Every array is as short as possible, and every loop is unrolled.
 * Behind each array is a guard, which the functions must not read or write.
 */
#include <stddef.h>

#include "anything.h"
#include "contracts.h"

void parameters(void)
{
    sh_least_squares rls, started;
    sh_innovation innovation;
    sh_real F[SH_MAX_PARAMETERS];
    int i;

    ANYTHING(F);
    sh_least_squares_start(&started, SH_MAX_PARAMETERS, F, any_real());
    sh_least_squares_start(&started, SH_MAX_PARAMETERS, NULL, any_real());
    ANYTHING(rls.eta);
    ANYTHING(rls.eta_low);
    ANYTHING(rls.P.U);
    for (i = 0; i < SH_MAX_PARAMETERS; ++i) {
        rls.P.columns[i].D = any_real();
    }
    rls.P.least = any_real();
    rls.P.size = SH_MAX_PARAMETERS;
    sh_least_squares_update(&rls, Frama_C_interval(SH_RLS_ENHANCED, SH_RLS_CONSTANT_FACTOR),
                            any_real(), F, any_real(), &innovation);
    sh_least_squares_variance(&rls, F);
    //@ assert guards: !\initialized(&rls.guard_eta[0]) && !\initialized(&rls.guard_eta_low[0]);
    //@ assert guards: !\initialized(&rls.P.guard_columns[0]) && !\initialized(&rls.P.guard_U[0]);
    //@ assert guards: !\initialized(&rls.P.guard_PF[0]);
}
