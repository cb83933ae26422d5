/* FMU with two estimators, one for each motor of an antagonistic pair. Both estimators use the encoder of the link.
 * The stiffness of the joint is the sum of both estimated stiffnesses (section II of the paper).
 */
#include <math.h>

#include "estimator_fmu.h"

typedef struct {
    sh_estimator_fmu side[2]; /* side[0] also holds the parameters that both estimators share */
    double sigma;             /* stiffness of the device [N.m/rad] */
    double sigma_std;         /* standard deviation of sigma for independent errors [N.m/rad] */
    int doubt;                /* SH_DOUBT_* of the device */
    int confident;            /* 1 if doubt is SH_DOUBT_NONE */
    int valid;
} AntagonisticStiffnessEstimator;

#include "variables.h"

static const char *const WHO[] = {"Motor 1: ", "Motor 2: "};

/* The parameters of one estimator: the common parameters with the data of its own motor. */
static sh_parameters parameters_of(const AntagonisticStiffnessEstimator *fmu, int i)
{
    sh_parameters p = fmu->side[0].parameters;

    p.motor = fmu->side[i].parameters.motor;
    return p;
}

/* Why the summed stiffness is not confident. One motor may move too little if the sum still has a small deviation. */
static int doubt_of_sum(const AntagonisticStiffnessEstimator *fmu)
{
    const int one = fmu->side[0].output.doubt, other = fmu->side[1].output.doubt;
    const int worst = one > other ? one : other;

    if (worst != SH_DOUBT_NOT_EXCITED && worst != SH_DOUBT_NONE) {
        return worst;
    }
    if (fmu->sigma_std < fmu->side[0].parameters.limit.relative_std * fabs(fmu->sigma)) {
        return SH_DOUBT_NONE;
    }
    return worst != SH_DOUBT_NONE ? worst : SH_DOUBT_NOT_EXCITED;
}

static void sum(AntagonisticStiffnessEstimator *fmu)
{
    fmu->sigma = fmu->side[0].output.sigma + fmu->side[1].output.sigma;
    fmu->sigma_std = hypot(fmu->side[0].output.sigma_std, fmu->side[1].output.sigma_std);
    fmu->doubt = doubt_of_sum(fmu);
    fmu->confident = fmu->doubt == SH_DOUBT_NONE;
    fmu->valid = fmu->side[0].output.valid && fmu->side[1].output.valid;
}

static sh_status check(const void *model, sh_instance *log)
{
    const AntagonisticStiffnessEstimator *fmu = model;
    int i;

    for (i = 0; i < 2; ++i) {
        const sh_parameters p = parameters_of(fmu, i);
        if (sh_estimator_fmu_check(&p, WHO[i], log) != SH_OK) {
            return SH_ERROR;
        }
    }
    return SH_OK;
}

static void initialize(void *model, double t)
{
    AntagonisticStiffnessEstimator *fmu = model;
    int i;

    (void)t; /* the estimator counts ticks */
    fmu->side[1].parameters = parameters_of(fmu, 1);
    for (i = 0; i < 2; ++i) {
        sh_estimator_fmu_initialize(&fmu->side[i]);
    }
    sum(fmu);
}

static int is_state(const void *model)
{
    const AntagonisticStiffnessEstimator *fmu = model;
    int i;

    for (i = 0; i < 2; ++i) {
        const sh_parameters p = parameters_of(fmu, i);
        if (!sh_estimator_fmu_is_state(&fmu->side[i], &p)) {
            return 0;
        }
    }
    return 1;
}

/* The parameters of which start values follow another one are common, and side[0] begins at offset 0. */
static void follow(void *model, size_t offset)
{
    AntagonisticStiffnessEstimator *fmu = model;

    sh_estimator_fmu_follow(&fmu->side[0], offset);
}

static sh_status step(void *model, double t, double h, int held, sh_instance *log)
{
    AntagonisticStiffnessEstimator *fmu = model;
    sh_status status = SH_OK;
    int i;

    fmu->side[1].input.q = fmu->side[0].input.q;
    fmu->side[1].input_derivative.q = fmu->side[0].input_derivative.q;
    fmu->side[1].parameters = parameters_of(fmu, 1);
    for (i = 0; i < 2; ++i) {
        const sh_status of_side = sh_estimator_fmu_step(&fmu->side[i], t, h, held, WHO[i], log);
        if (of_side > status) {
            status = of_side;
        }
    }
    sum(fmu);
    return status;
}

SH_DEFINE_MODEL(AntagonisticStiffnessEstimator, SH_ESTIMATOR_DERIVATIVE_OFFSET, check, follow);
