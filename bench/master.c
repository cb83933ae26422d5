#include "master.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

enum { MAX_VARIABLES = 32 };

typedef struct {
    fmi2CallbackFunctions callbacks; /* the FMU keeps a pointer to it */
    fmi2Component component;
    fmi2SetRealTYPE *set;
    fmi2SetRealInputDerivativesTYPE *set_slopes;
    fmi2DoStepTYPE *step;
    fmi2GetRealTYPE *get;
    fmi2ValueReference inputs[MAX_VARIABLES], outputs[MAX_VARIABLES];
    fmi2Integer orders[MAX_VARIABLES];
    size_t input_count, output_count;
    int slopes;
    double time;
} master;

static void say(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                fmi2String category, fmi2String message, ...)
{
    (void)environment;
    (void)category;
    if (status > fmi2OK) {
        fprintf(stderr, "%s: %s\n", name, message);
    }
}

/* Function of a library; ISO C has no cast from void * to it. */
#define FIND(library, function)                                                                    \
    do {                                                                                           \
        void *symbol = dlsym(library, #function);                                                  \
        memcpy(&function, &symbol, sizeof symbol);                                                 \
        if (symbol == NULL)                                                                        \
            return NULL;                                                                           \
    } while (0)

void *master_start(const char *binary, const char *guid, const char *resources,
                   const unsigned *inputs, int input_count, const unsigned *outputs,
                   int output_count, int slopes)
{
    void *library = dlopen(binary, RTLD_NOW | RTLD_LOCAL);
    fmi2InstantiateTYPE *fmi2Instantiate;
    fmi2SetupExperimentTYPE *fmi2SetupExperiment;
    fmi2EnterInitializationModeTYPE *fmi2EnterInitializationMode;
    fmi2ExitInitializationModeTYPE *fmi2ExitInitializationMode;
    fmi2SetRealTYPE *fmi2SetReal;
    fmi2SetRealInputDerivativesTYPE *fmi2SetRealInputDerivatives;
    fmi2DoStepTYPE *fmi2DoStep;
    fmi2GetRealTYPE *fmi2GetReal;
    master *own = calloc(1, sizeof *own);
    int i;

    if (library == NULL || own == NULL || input_count > MAX_VARIABLES ||
        output_count > MAX_VARIABLES) {
        return NULL;
    }
    FIND(library, fmi2Instantiate);
    FIND(library, fmi2SetupExperiment);
    FIND(library, fmi2EnterInitializationMode);
    FIND(library, fmi2ExitInitializationMode);
    FIND(library, fmi2SetReal);
    FIND(library, fmi2SetRealInputDerivatives);
    FIND(library, fmi2DoStep);
    FIND(library, fmi2GetReal);
    own->set = fmi2SetReal;
    own->set_slopes = fmi2SetRealInputDerivatives;
    own->step = fmi2DoStep;
    own->get = fmi2GetReal;
    own->callbacks.logger = say;
    own->callbacks.allocateMemory = calloc;
    own->callbacks.freeMemory = free;
    own->input_count = (size_t)input_count;
    own->output_count = (size_t)output_count;
    own->slopes = slopes;
    for (i = 0; i < input_count; ++i) {
        own->inputs[i] = inputs[i];
        own->orders[i] = 1;
    }
    for (i = 0; i < output_count; ++i) {
        own->outputs[i] = outputs[i];
    }
    own->component = fmi2Instantiate("bench", fmi2CoSimulation, guid, resources, &own->callbacks,
                                     fmi2False, fmi2False);
    if (own->component == NULL ||
        fmi2SetupExperiment(own->component, fmi2False, 0.0, 0.0, fmi2False, 0.0) != fmi2OK ||
        fmi2EnterInitializationMode(own->component) != fmi2OK ||
        fmi2ExitInitializationMode(own->component) != fmi2OK) {
        return NULL;
    }
    return own;
}

static int get(master *own, double *y)
{
    return own->get(own->component, own->outputs, own->output_count, y) != fmi2OK;
}

/* Sets inputs and makes a step; `next` has the inputs at its end. */
static int step(master *own, const double *row, const double *next, double h)
{
    double slopes[MAX_VARIABLES];
    int failed = own->set(own->component, own->inputs, own->input_count, row) != fmi2OK;
    size_t i;

    if (own->slopes) {
        for (i = 0; i < own->input_count; ++i) {
            slopes[i] = (next[i] - row[i]) / h;
        }
        failed += own->set_slopes(own->component, own->inputs, own->input_count, own->orders,
                                  slopes) != fmi2OK;
    }
    failed += own->step(own->component, own->time, h, fmi2True) != fmi2OK;
    own->time += h;
    return failed;
}

int master_run(void *instance, const double *u, int samples, double h, double *y)
{
    master *own = instance;
    int failed = 0, k;

    for (k = 0; k < samples; ++k) {
        const double *row = u + (size_t)k * own->input_count;

        failed += step(own, row, k + 1 < samples ? row + own->input_count : row, h);
        failed += get(own, y);
    }
    return failed;
}

int master_run_pair(void *from, void *to, const double *u, int samples, double h, double *y_from,
                    double *y_to)
{
    master *plant = from, *estimator = to;
    int failed = 0, k;

    for (k = 0; k < samples; ++k) {
        const double *row = u + (size_t)k * plant->input_count;

        failed += get(plant, y_from);
        failed += step(estimator, y_from, y_from, h);
        failed += get(estimator, y_to);
        failed += step(plant, row, k + 1 < samples ? row + plant->input_count : row, h);
    }
    return failed;
}
