/* Connects the stiffness estimator to the FMI shell, which implements the functions of FMI. */
#include <math.h>

#include "estimator_fmu.h"
#include "variables.h"

static sh_status check(const void *model, sh_instance *log)
{
    const sh_estimator_fmu *fmu = model;

    return sh_estimator_fmu_check(&fmu->parameters, "", log);
}

static void initialize(void *model, double t)
{
    (void)t; /* the estimator counts ticks */
    sh_estimator_fmu_initialize(model);
}

static int is_state(const void *model)
{
    const sh_estimator_fmu *fmu = model;

    return sh_estimator_fmu_is_state(fmu, &fmu->parameters);
}

static void follow(void *model, size_t offset)
{
    sh_estimator_fmu_follow(model, offset);
}

static sh_status step(void *model, double t, double h, int held, sh_instance *log)
{
    return sh_estimator_fmu_step(model, t, h, held, "", log);
}

SH_DEFINE_MODEL(sh_estimator_fmu, SH_ESTIMATOR_DERIVATIVE_OFFSET, check, follow);
