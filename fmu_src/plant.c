/* Binding of a plant to the FMI shell, the same for every plant. */
#include "plant.h"

#include <math.h>
#include <stddef.h>

#include "model.h"
#include "noise.h"
#include "radau.h"
#include "variables.h"

/* Outputs of the state x under the inputs u, with noise of the sample given. */
static void set_outputs(sh_plant *plant, const double *u, uint64_t sample)
{
    double normals[SH_PLANT_NORMALS + 1]; /* a plant may have none */
    const double *arguments[] = {plant->x, u, plant->p, normals};
    double *results[] = {plant->y};
    int channel;

    for (channel = 0; channel < SH_PLANT_NORMALS; ++channel)
        normals[channel] = sh_noise_normal(plant->seed, sample, (unsigned)channel);
    sh_plant_outputs(arguments, results, NULL, NULL, 0);
    plant->sample = sample;
}

static void initialize(void *model)
{
    sh_plant *plant = model;
    const double *arguments[] = {plant->p};
    double *results[] = {plant->x};

    sh_plant_start(arguments, results, NULL, NULL, 0);
    plant->h = INFINITY;
    set_outputs(plant, plant->u, 0);
}

static const char *input_name(size_t i)
{
    size_t k = 0;

    while (VARIABLES[k].offset != offsetof(sh_plant, u) + i * sizeof(double))
        ++k;
    return VARIABLES[k].name;
}

static sh_status step(void *model, double t, double h, sh_instance *log)
{
    sh_plant *plant = model;
    double x[SH_PLANT_STATES], u_end[SH_PLANT_INPUTS], internal_step = plant->h;
    size_t i;

    for (i = 0; i < SH_PLANT_INPUTS; ++i) {
        u_end[i] = plant->u[i] + plant->du[i] * h;
        if (!isfinite(plant->u[i]) || !isfinite(u_end[i])) {
            sh_log(log, SH_ERROR,
                   "Step from t = %.9g s refused, the state is kept: expected a finite input "
                   "%s, received %g at its begin and %g at its end.",
                   t, input_name(i), plant->u[i], u_end[i]);
            return SH_ERROR;
        }
    }
    for (i = 0; i < SH_PLANT_STATES; ++i)
        x[i] = plant->x[i];
    if (sh_radau_integrate(x, plant->u, plant->du, plant->p, h, &internal_step) == 0) {
        sh_log(log, SH_ERROR,
               "Step from t = %.9g s to %.9g s refused, the state is kept: the equations have "
               "no solution there, or it takes more than a million internal steps. Look for "
               "extreme inputs or parameters.",
               t, t + h);
        return SH_ERROR;
    }
    for (i = 0; i < SH_PLANT_STATES; ++i)
        plant->x[i] = x[i];
    plant->h = internal_step;
    set_outputs(plant, u_end, plant->sample + 1);
    return SH_OK;
}

const sh_model sh_fmu_model = {
    .identifier = SH_IDENTIFIER,
    .guid = SH_GUID,
    .size = sizeof(sh_plant),
    .variables = VARIABLES,
    .count = sizeof VARIABLES / sizeof VARIABLES[0],
    .derivative_offset = offsetof(sh_plant, du) - offsetof(sh_plant, u),
    .check = NULL,
    .initialize = initialize,
    .step = step,
};
