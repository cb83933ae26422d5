/* sh_parameters_check for parameters of any bits: it refuses what any_parameters leaves out. */
#include "anything.h"

static sh_parameters p;
static sh_violation violation;

#define REFUSED(designator, value)                                                                 \
    do {                                                                                           \
        int result;                                                                                \
        ANYTHING(p);                                                                               \
        p.designator = (value);                                                                    \
        result = sh_parameters_check(&p, &violation);                                              \
        /*@ assert refused: result == 1; */                                                        \
    } while (0)

#define ONLY(designator, least, most)                                                              \
    do {                                                                                           \
        REFUSED(designator, Frama_C_interval(-2147483647 - 1, (least) - 1));                       \
        REFUSED(designator, Frama_C_interval((most) + 1, 2147483647));                             \
    } while (0)

/* The parameters that `refused` leaves. */
void in_range(void)
{
    sh_real period;

    any_parameters(&p);
    if (sh_parameters_check(&p, &violation) == 0) {
        sh_parameters_largest_deformation(&p);
    }
    ANYTHING(period);
    sh_parameters_default_at(&p, period);
    //@ assert reached: \true;
}

void refused(void)
{
    ONLY(method, SH_METHOD_PAPER2011, SH_METHOD_FILTERED_REGRESSION);
    ONLY(modality, SH_MODALITY_RESIDUAL, SH_MODALITY_MODEL);
    ONLY(deformation, SH_DEFORMATION_RAW, SH_DEFORMATION_FILTERED);
    ONLY(filter.kind, SH_FILTER_MODIFIED_KALMAN, SH_FILTER_FINITE_DIFFERENCE);
    ONLY(filter.weighting, SH_WEIGHTING_NORMALIZED, SH_WEIGHTING_AS_PRINTED);
    ONLY(rls.kind, SH_RLS_ENHANCED, SH_RLS_CONSTANT_FACTOR);
    ONLY(rls.symmetric, 0, 1);
    ONLY(rls.n, 1, SH_MAX_N);
    ONLY(rls.m, 1, SH_MAX_M);
    ONLY(torque.held, 0, 1);
    ONLY(regression.decimation, 0, 64);
    REFUSED(prior.nominal, (sh_real)Frama_C_float_interval(-3e38f, -1e-45f));
    REFUSED(prior.tau_e, (sh_real)Frama_C_float_interval(-3e38f, -1e-45f));
    //@ assert reached: \true;
}
