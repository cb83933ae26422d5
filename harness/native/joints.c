#include "joints.h"

#include <math.h>
#include <string.h>

#include "variables.h"

const char *sh_joint_guid(void)
{
    return SH_GUID;
}

size_t sh_joint_size(void)
{
    return sizeof(sh_joint);
}

size_t sh_joint_place(unsigned variable)
{
    return VARIABLES[variable].offset;
}

void sh_joint_set(sh_joint *joint, unsigned variable, double value)
{
    void *place = (char *)joint + VARIABLES[variable].offset;

    if (VARIABLES[variable].type == SH_TYPE_REAL) {
        *(double *)place = value;
    } else {
        *(int *)place = (int)value;
    }
}

void sh_joint_default(sh_joint *joint, double samplePeriod)
{
    unsigned i;

    memset(joint, 0, sizeof *joint);
    for (i = 0; i < sizeof VARIABLES / sizeof VARIABLES[0]; ++i) {
        sh_joint_set(joint, i, VARIABLES[i].start);
    }
    sh_parameters_default_at(&joint->parameters, samplePeriod);
}

int sh_joint_check(const sh_joint *joint, sh_violation *violation)
{
    return sh_parameters_check(&joint->parameters, violation);
}

void sh_joint_start(sh_joint *joint)
{
    sh_estimator_start(&joint->estimator, &joint->parameters, &joint->output);
}

void sh_joint_evaluate(const sh_joint *joint, size_t count, const double *phi,
                       const double *set_point, sh_point *points)
{
    size_t k;

    for (k = 0; k < count; ++k) {
        (void)sh_estimator_evaluate(&joint->estimator, &joint->parameters, phi[k], set_point[k],
                                    &points[k]);
    }
}

int sh_joint_covariance(const sh_joint *joint, size_t count, const double *phi,
                        const double *set_point, double *values, double *per_gain,
                        double *covariance)
{
    return sh_estimator_covariance(&joint->estimator, &joint->parameters, (int)count, phi,
                                   set_point, values, per_gain, covariance);
}

/* Writes the outputs of the last tick to place k of their arrays. */
static void record(const sh_joint *joint, const sh_joint_output *outputs, size_t count, size_t k)
{
    size_t i;

    for (i = 0; i < count; ++i) {
        const sh_variable *variable = &VARIABLES[outputs[i].variable];
        const void *place = (const char *)joint + variable->offset;

        if (variable->type == SH_TYPE_REAL) {
            ((double *)outputs[i].values)[k] = *(const double *)place;
        } else {
            ((int *)outputs[i].values)[k] = *(const int *)place;
        }
    }
}

static double at(const double *samples, size_t k)
{
    return samples == NULL ? 0.0 : samples[k];
}

void sh_joints_run(char *memory, size_t joints, size_t stride, size_t samples, size_t first,
                   size_t end, const double *theta, const double *q, const double *theta_c,
                   const double *tau, const double *tau_e_sensor, const sh_joint_output *outputs,
                   size_t count)
{
    size_t j, k;

    for (j = 0; j < joints; ++j) {
        sh_joint *joint = (sh_joint *)(void *)(memory + j * stride);

        for (k = j * samples + first; k < j * samples + end; ++k) {
            const sh_measurement z = {at(theta, k), at(q, k), at(theta_c, k), at(tau, k),
                                      at(tau_e_sensor, k)};

            sh_estimator_tick(&joint->estimator, &joint->parameters, &z, &joint->output);
            record(joint, outputs, count, k);
        }
    }
}
