/* Connects the generated equations of a plant to the FMI shell. All plants share this file. */
#include "plant.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "model.h"
#include "noise.h"
#include "radau.h"
#include "variables.h"

/* Largest number of sample periods of the noise in one step, a number that a double represents exactly. */
static const double MAX_PERIODS = 1e15;

/* Computes the outputs for the state x and the inputs u. */
static void set_outputs(sh_plant *plant, const double *u)
{
    double normals[SH_PLANT_NORMALS + 1]; /* a plant may have none */
    const double *arguments[] = {plant->x, u, plant->p, normals};
    double *results[] = {plant->y};
    int channel;

    for (channel = 0; channel < SH_PLANT_NORMALS; ++channel) {
        normals[channel] = sh_noise_normal(plant->seed, plant->sample, (unsigned)channel);
    }
    (void)sh_plant_outputs(arguments, results, NULL, NULL, 0);
}

/* Advances to the last noise sample that is due at the end of a step. Noise samples are one period apart. As in
 * estimator_fmu.c, time is counted in periods. A noise sample that is due less than 1e-6 of a period after the end
 * of the step counts as due.
 */
static void advance_noise(sh_plant *plant, double periods)
{
    const double since = plant->since + periods;
    const double samples = fmax(floor(since + 1e-6), 0.0);

    plant->since = since - samples;
    plant->sample += (uint64_t)samples;
}

static void initialize(void *model, double t)
{
    sh_plant *plant = model;
    const double *arguments[] = {plant->p};
    double *results[] = {plant->x};

    (void)sh_plant_start(arguments, results, NULL, NULL, 0);
    plant->h = INFINITY;
    plant->started = t;
    plant->since = 0.0;
    plant->sample = 0;
    set_outputs(plant, plant->u);
}

/* Returns 1 if a simulation can continue from this state. With an internal step length of 0 or less, the integrator
 * would never finish. The age of the noise sample must be at most one period.
 */
static int is_state(const void *model)
{
    const sh_plant *plant = model;
    int i;

    for (i = 0; i < SH_PLANT_STATES; ++i) {
        if (!isfinite(plant->x[i])) {
            return 0;
        }
    }
    return plant->h > 0.0 && plant->since >= -1.0 && plant->since <= 1.0;
}

static const char *input_name(size_t i)
{
    size_t k = 0;

    while (VARIABLES[k].offset != offsetof(sh_plant, u) + i * sizeof(double)) {
        ++k;
    }
    return VARIABLES[k].name;
}

/* Returns the value at time t of the sine that is added to input i. At the start of the simulation this sine is 0. */
static double sine(const sh_plant *plant, size_t i, double t)
{
    static const double TURN = 6.283185307179586;

    if (plant->amplitude[i] == 0.0) {
        return 0.0;
    }
    return plant->amplitude[i] * sin(TURN * plant->frequency[i] * (t - plant->started));
}

/* Returns the index of the input with the largest magnitude during a step. */
static size_t largest_input(const double *u, const double *u_end)
{
    size_t i, largest = 0;

    for (i = 1; i < SH_PLANT_INPUTS; ++i) {
        if (fmax(fabs(u[i]), fabs(u_end[i])) > fmax(fabs(u[largest]), fabs(u_end[largest]))) {
            largest = i;
        }
    }
    return largest;
}

static sh_status step(void *model, double t, double h, int held, sh_instance *log)
{
    sh_plant *plant = model;
    double x[SH_PLANT_STATES], u[SH_PLANT_INPUTS], du[SH_PLANT_INPUTS], u_end[SH_PLANT_INPUTS];
    double internal_step = plant->h;
    const double periods = SH_PLANT_NORMALS > 0 ? h / plant->samplePeriod : 0.0; /* of the noise */
    size_t i;

    (void)held; /* a held torque is a torque */
    for (i = 0; i < SH_PLANT_INPUTS; ++i) {
        const double begin = sine(plant, i, t), end = sine(plant, i, t + h);

        u[i] = plant->u[i] + begin;
        du[i] = plant->du[i] + (end - begin) / h;
        u_end[i] = plant->u[i] + plant->du[i] * h + end;
        if (!isfinite(u[i]) || !isfinite(u_end[i])) {
            sh_report(log, SH_ERROR,
                      "Step from t = %.9g s refused, the state is kept: expected a finite input "
                      "%s, received %g at its begin and %g at its end.",
                      t, input_name(i), u[i], u_end[i]);
            return SH_ERROR;
        }
    }
    if (!(periods <= MAX_PERIODS)) {
        sh_report(
            log, SH_ERROR,
            "Step from t = %.9g s refused, the state is kept: its length %g s is more than %g "
            "times noise.samplePeriod = %g s; expected a shorter step.",
            t, h, MAX_PERIODS, plant->samplePeriod);
        return SH_ERROR;
    }
    (void)memcpy(x, plant->x, sizeof x);
    if (sh_radau_integrate(x, u, du, plant->p, h, &internal_step) == 0) {
        i = largest_input(u, u_end);
        sh_report(log, SH_ERROR,
                  "Step from t = %.9g s to %.9g s refused, the state is kept: the equations have "
                  "no solution there, or it takes more than %d internal steps. Expected inputs and "
                  "parameters of a joint; the largest input is %s = %g.",
                  t, t + h, sh_radau_attempts(h), input_name(i),
                  fabs(u_end[i]) > fabs(u[i]) ? u_end[i] : u[i]);
        return SH_ERROR;
    }
    (void)memcpy(plant->x, x, sizeof x);
    plant->h = internal_step;
    if (SH_PLANT_NORMALS > 0) {
        advance_noise(plant, periods);
    }
    set_outputs(plant, u_end);
    return SH_OK;
}

SH_DEFINE_MODEL(sh_plant, offsetof(sh_plant, du) - offsetof(sh_plant, u), NULL, NULL);
