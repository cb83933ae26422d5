#include "method.h"

#include <stddef.h>

#include "real_math.h"

#define SH_METHOD_ENTRY(constant, number, name, block) [constant] = &(block),
static const sh_method *const METHODS[] = {SH_METHODS(SH_METHOD_ENTRY)};

const sh_method *sh_method_of(const sh_parameters *p)
{
    const int count = sizeof METHODS / sizeof METHODS[0];

    return p->method >= 0 && p->method < count ? METHODS[p->method] : NULL;
}

int sh_violates(sh_violation *violation, const char *name, sh_real value, const char *range)
{
    violation->name = name;
    violation->value = value;
    violation->range = range;
    return 1;
}

sh_real sh_encoder_count(sh_real counts_per_turn)
{
    return counts_per_turn > 0 ? (sh_real)(2 * SH_PI) / counts_per_turn : 0;
}

/* Nominal flexibility torque at the measured positions, (28) with (30) [N.m]. */
static sh_real nominal_torque(const sh_parameters *p, const sh_measurement *z)
{
    const sh_real r = p->model.r_0 - p->model.b * z->theta_c;

    return p->model.k_s * r * r * sh_sin(2 * (z->q - z->theta));
}

sh_real sh_regression_torque(const sh_parameters *p, const sh_measurement *z, sh_real from_motor)
{
    return p->modality == SH_MODALITY_SENSOR  ? z->tau_e_sensor
           : p->modality == SH_MODALITY_MODEL ? nominal_torque(p, z)
                                              : from_motor;
}
