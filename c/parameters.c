/* Start values and ranges of the parameters of the stiffness estimator. */
#include <stddef.h>
#include <string.h>

#include "method.h"
#include "real_math.h"

/* Entries of the parameter tables in parameters.inc, one struct for each type of parameter. */
typedef struct {
    const char *name;
    size_t offset; /* in sh_parameters */
    const char *range;
    sh_real start;
    sh_real min, max;  /* allowed, too */
    int within_period; /* 1: starts at most at 1 / samplePeriod */
} real_parameter;

typedef struct {
    const char *name;
    size_t offset;
    const char *range;
    int start;
    int min, max;
} integer_parameter;

#define AT(place) #place, offsetof(sh_parameters, place)
#define REAL(place, start, min, max, range)                                                        \
    {AT(place), range, (sh_real)(start), (sh_real)(min), (sh_real)(max), 0},
#define RATE(place, start, min, max, range)                                                        \
    {AT(place), range, (sh_real)(start), (sh_real)(min), (sh_real)(max), 1},
#define INTEGER(place, start, min, max, range) {AT(place), range, start, min, max},

/* The limits 1e-9, 1e-15 and 1e-30 replace the condition "above 0", and are far below the values of real machines. The
 * limits 1e-12, 1e-6, 1e6 and 1e12 belong to parameters that are squared or raised to a power. Within these wide
 * limits, the powers stay finite.
 */
#include "parameters.inc"

enum {
    REAL_COUNT = sizeof REALS / sizeof REALS[0],
    INTEGER_COUNT = sizeof INTEGERS / sizeof INTEGERS[0]
};

void sh_parameters_default(sh_parameters *p)
{
    char *bytes = (char *)p;
    int i;

    (void)memset(p, 0, sizeof *p);
    for (i = 0; i < REAL_COUNT; ++i) {
        *(sh_real *)(void *)(bytes + REALS[i].offset) = REALS[i].start;
    }
    for (i = 0; i < INTEGER_COUNT; ++i) {
        const integer_parameter *r = &INTEGERS[i];
        /* The compiler option -DSH_MAX_N or -DSH_MAX_M may set a maximum below the start value. */
        *(int *)(void *)(bytes + r->offset) = r->start < r->max ? r->start : r->max;
    }
}

void sh_parameters_default_at(sh_parameters *p, sh_real samplePeriod)
{
    char *bytes = (char *)p;
    int i;

    sh_parameters_default(p);
    p->samplePeriod = samplePeriod;
    for (i = 0; i < REAL_COUNT; ++i) {
        sh_real *value = (sh_real *)(void *)(bytes + REALS[i].offset);
        if (REALS[i].within_period && *value * samplePeriod > 1) {
            *value = 1 / samplePeriod;
        }
    }
}

int sh_parameters_check(const sh_parameters *p, sh_violation *violation)
{
    const char *bytes = (const char *)p;
    int i, j;

    for (i = 0; i < REAL_COUNT; ++i) {
        const real_parameter *r = &REALS[i];
        const sh_real value = *(const sh_real *)(const void *)(bytes + r->offset);
        if (!isfinite(value) || value < r->min || value > r->max) {
            return sh_violates(violation, r->name, value, r->range);
        }
    }
    for (i = 0; i < INTEGER_COUNT; ++i) {
        const integer_parameter *r = &INTEGERS[i];
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
