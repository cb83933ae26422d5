/* Start values and ranges of the parameters of the stiffness estimator. */
#include <stddef.h>
#include <string.h>

#include "method.h"
#include "real_math.h"

void sh_parameters_default(sh_parameters *p)
{
    (void)memset(p, 0, sizeof *p);
    p->samplePeriod = (sh_real)1e-3;
    p->method = SH_METHOD_PAPER2011;
    p->modality = SH_MODALITY_RESIDUAL;
    p->deformation = SH_DEFORMATION_RAW;
    p->motor.B = (sh_real)2.3e-5;
    p->motor.D_theta = (sh_real)1e-3;
    p->motor.gamma = 50;
    p->residual.K_I = 300;
    p->filter.kind = SH_FILTER_MODIFIED_KALMAN;
    p->filter.weighting = SH_WEIGHTING_NORMALIZED;
    p->filter.V_a = (sh_real)3e9;
    p->filter.V_max = 10;
    p->filter.V_min = (sh_real)0.1;
    p->filter.alpha = 6;
    p->filter.R = 10;
    p->filter.P_0 = 1;
    p->encoder.theta = 40000;
    p->encoder.q = 40000;
    p->encoder.theta_c = 1024;
    p->setPoint.offset = 100;
    p->setPoint.scale = (sh_real)(-0.0025 / (2 * SH_PI) * 1000);
    p->rls.kind = SH_RLS_ENHANCED;
    p->rls.symmetric = 1;
    p->rls.n = SH_MAX_N < 6 ? SH_MAX_N : 6; /* a smaller size was given to the compiler */
    p->rls.m = SH_MAX_M < 3 ? SH_MAX_M : 3;
    p->rls.P_0 = (sh_real)1e20;
    p->rls.c = (sh_real)1e-20;
    p->rls.a = (sh_real)0.1;
    p->model.k_s = 14220;
    p->model.r_0 = (sh_real)0.1;
    p->model.b = (sh_real)(0.0025 / (2 * SH_PI));
    p->noise.tau = (sh_real)3.2e-3;
    p->noise.tau_e = (sh_real)3.2e-2;
    p->limit.relative_std = (sh_real)0.1;
    p->regression.bandwidth = 350;
    p->regression.slow = (sh_real)0.05;
    p->regression.drift = 0;
    p->regression.memory = 20;
    p->range.phi = (sh_real)0.3;
    p->range.setPoint = 100;
    p->prior.tau_e = 45;
    p->prior.nominal = 0;
    p->prior.D_theta = (sh_real)0.2;
    p->prior.B = 0;
    p->prior.tau_coulomb = (sh_real)0.02;
    p->prior.torque_gain = (sh_real)0.02;
    p->prior.bias = (sh_real)0.05;
    p->prior.damping = (sh_real)4e-3;
    p->prior.load_friction = (sh_real)0.05;
    p->prior.eccentric = (sh_real)3e-4;
    p->prior.delay = (sh_real)2e-3;
    p->prior.reversal = (sh_real)2e-3;
    p->prior.power = 1;
    p->prior.gap = (sh_real)0.02;
    p->prior.hysteresis = (sh_real)0.01;
    p->prior.eccentric_motor = (sh_real)1e-4;
}

/* Allowed range of one parameter. */
typedef struct {
    const char *name;
    size_t offset; /* in sh_parameters */
    const char *range;
    sh_real min, max; /* allowed, too */
} real_range;

typedef struct {
    const char *name;
    size_t offset;
    const char *range;
    int min, max;
} integer_range;

#define AT(designator) #designator, offsetof(sh_parameters, designator)

/* 1e-9, 1e-15 and 1e-30 are least values of what must be above 0: far below what a machine has.
 * Limits of 1e-12, 1e-6, 1e6 and 1e12 are wide ones of what is squared or raised to a power: within
 * them the numbers stay finite.
 */
static const real_range REALS[] = {
    {AT(samplePeriod), ">= 1e-9", (sh_real)1e-9, INFINITY},
    {AT(motor.B), ">= 1e-15", (sh_real)1e-15, INFINITY},
    {AT(motor.D_theta), ">= 0", 0, INFINITY},
    {AT(motor.gamma), "finite and not 0", -INFINITY, INFINITY},
    {AT(residual.K_I), ">= 1e-15", (sh_real)1e-15, INFINITY},
    {AT(filter.V_a), ">= 0", 0, INFINITY},
    {AT(filter.V_max), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(filter.V_min), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(filter.alpha), ">= 0", 0, INFINITY},
    {AT(filter.R), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(filter.P_0), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(encoder.theta), ">= 0 (0: no quantisation)", 0, INFINITY},
    {AT(encoder.q), ">= 0 (0: no quantisation)", 0, INFINITY},
    {AT(encoder.theta_c), ">= 0 (0: no quantisation)", 0, INFINITY},
    {AT(setPoint.offset), "finite", -INFINITY, INFINITY},
    {AT(setPoint.scale), "finite", -INFINITY, INFINITY},
    {AT(rls.P_0), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(rls.c), ">= 1e-30", (sh_real)1e-30, INFINITY},
    {AT(rls.a), "1e-15 to 1", (sh_real)1e-15, 1},
    {AT(model.k_s), ">= 0", 0, INFINITY},
    {AT(model.r_0), "finite", -INFINITY, INFINITY},
    {AT(model.b), "finite", -INFINITY, INFINITY},
    {AT(noise.tau), "1e-12 to 1e12", (sh_real)1e-12, (sh_real)1e12},
    {AT(noise.tau_e), "1e-12 to 1e12", (sh_real)1e-12, (sh_real)1e12},
    {AT(limit.relative_std), ">= 1e-15", (sh_real)1e-15, INFINITY},
    {AT(regression.bandwidth), ">= 1e-15", (sh_real)1e-15, INFINITY},
    {AT(regression.slow), ">= 1e-15", (sh_real)1e-15, INFINITY},
    {AT(regression.drift), "0 to 1e12", 0, (sh_real)1e12},
    {AT(regression.memory), "0 to 1e12", 0, (sh_real)1e12},
    {AT(range.phi), "1e-6 to 1e6", (sh_real)1e-6, (sh_real)1e6},
    {AT(range.setPoint), "1e-12 to 1e12", (sh_real)1e-12, (sh_real)1e12},
    {AT(prior.tau_e), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.nominal), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.D_theta), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.B), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.tau_coulomb), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.torque_gain), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.bias), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.damping), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.load_friction), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.eccentric), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.delay), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.reversal), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.power), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.gap), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.hysteresis), "0 to 1e12", 0, (sh_real)1e12},
    {AT(prior.eccentric_motor), "0 to 1e12", 0, (sh_real)1e12},
};

static const integer_range INTEGERS[] = {
    {AT(modality), "1 (Residual), 2 (Sensor) or 3 (Model)", SH_MODALITY_RESIDUAL,
     SH_MODALITY_MODEL},
    {AT(deformation), "1 (Raw) or 2 (Filtered)", SH_DEFORMATION_RAW, SH_DEFORMATION_FILTERED},
    {AT(filter.kind), "1 (ModifiedKalman), 2 (Kalman) or 3 (FiniteDifference)",
     SH_FILTER_MODIFIED_KALMAN, SH_FILTER_FINITE_DIFFERENCE},
    {AT(filter.weighting), "1 (Normalized) or 2 (AsPrinted)", SH_WEIGHTING_NORMALIZED,
     SH_WEIGHTING_AS_PRINTED},
    {AT(rls.kind), "1 (Enhanced), 2 (Standard) or 3 (ConstantFactor)", SH_RLS_ENHANCED,
     SH_RLS_CONSTANT_FACTOR},
    {AT(rls.symmetric), "0 or 1", 0, 1},
    {AT(rls.n), "1 to " SH_TEXT_OF(SH_MAX_N), 1, SH_MAX_N},
    {AT(rls.m), "1 to " SH_TEXT_OF(SH_MAX_M), 1, SH_MAX_M},
    {AT(torque.held), "0 or 1", 0, 1},
};

enum {
    REAL_COUNT = sizeof REALS / sizeof REALS[0],
    INTEGER_COUNT = sizeof INTEGERS / sizeof INTEGERS[0]
};

int sh_parameters_check(const sh_parameters *p, sh_violation *violation)
{
    const char *bytes = (const char *)p;
    int i, j;

    for (i = 0; i < REAL_COUNT; ++i) {
        const real_range *r = &REALS[i];
        const sh_real value = *(const sh_real *)(const void *)(bytes + r->offset);
        if (!isfinite(value) || value < r->min || value > r->max) {
            return sh_violates(violation, r->name, value, r->range);
        }
    }
    if (sh_method_of(p) == NULL) {
        return sh_violates(violation, "method", (sh_real)p->method, sh_method_names());
    }
    for (i = 0; i < INTEGER_COUNT; ++i) {
        const integer_range *r = &INTEGERS[i];
        const int value = *(const int *)(const void *)(bytes + r->offset);
        if (value < r->min || value > r->max) {
            return sh_violates(violation, r->name, (sh_real)value, r->range);
        }
    }
    for (i = 0; i < SH_MAX_N; ++i) {
        for (j = 0; j < SH_MAX_M; ++j) {
            if (!isfinite(p->rls.eta_0[i][j])) {
                return sh_violates(violation, "rls.eta_0", p->rls.eta_0[i][j], "finite");
            }
        }
    }
    if (!(p->motor.gamma > 0) && !(p->motor.gamma < 0)) {
        return sh_violates(violation, "motor.gamma", p->motor.gamma, "finite and not 0");
    }
    if (p->filter.V_min > p->filter.V_max) {
        return sh_violates(violation, "filter.V_min", p->filter.V_min,
                           ">= 1e-30 and <= filter.V_max");
    }
    return sh_method_of(p)->check(p, violation);
}

sh_real sh_parameters_largest_deformation(const sh_parameters *p)
{
    return sh_method_of(p)->largest_deformation(p);
}
