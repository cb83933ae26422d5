/* Values about which the analyser knows nothing but their type. */
#ifndef ANYTHING_H
#define ANYTHING_H

#include <__fc_builtin.h>

#include "sigmahat.h"

#define ANYTHING(object) Frama_C_make_unknown((char *)&(object), sizeof(object))

static sh_real any_real(void)
{
    sh_real value;

    ANYTHING(value);
    return value;
}

/* Parameters with every choice and order in its range, and every other number of any bits. The parameters that pass
 * sh_parameters_check are among them: check.c. The curve needs columns: PROOF_CURVE 1 stands for
 * prior.tau_e > 0; 0 for prior.tau_e = 0, where prior.nominal is positive.
 */
static void any_parameters(sh_parameters *p)
{
    ANYTHING(*p);
    p->method = PROOF_METHOD;
    p->modality = Frama_C_interval(SH_MODALITY_RESIDUAL, SH_MODALITY_MODEL);
    p->deformation = Frama_C_interval(SH_DEFORMATION_RAW, SH_DEFORMATION_FILTERED);
    p->filter.kind = Frama_C_interval(SH_FILTER_MODIFIED_KALMAN, SH_FILTER_FINITE_DIFFERENCE);
    p->filter.weighting = Frama_C_interval(SH_WEIGHTING_NORMALIZED, SH_WEIGHTING_AS_PRINTED);
    p->rls.kind = Frama_C_interval(SH_RLS_ENHANCED, SH_RLS_CONSTANT_FACTOR);
    p->rls.symmetric = Frama_C_interval(0, 1);
    p->rls.n = Frama_C_interval(1, SH_MAX_N);
    p->rls.m = Frama_C_interval(1, SH_MAX_M);
    p->torque.held = Frama_C_interval(0, 1);
    p->regression.decimation = Frama_C_interval(0, 64);
    p->prior.tau_e = PROOF_CURVE ? (sh_real)Frama_C_float_interval(1e-45f, 1e12f) : 0;
    if (!PROOF_CURVE) {
        p->prior.nominal = (sh_real)Frama_C_float_interval(1e-45f, 1e12f);
    }
}

#endif
