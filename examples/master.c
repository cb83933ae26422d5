/* A co-simulation master in plain C for StiffnessEstimator.fmu: docs/how-to/c-master.md.
 *
 * master FOLDER LIBRARY: the folder of the unpacked FMU and its shared library. Feeds the estimator for two seconds,
 * and prints the stiffness. The joint swings once per second, and has a spring of 150 N.m/rad and a torque sensor.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

static char *description; /* text of modelDescription.xml */
static void *library;

/* The functions of the FMU that are used here. */
static struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2SetupExperimentTYPE *setup_experiment;
    fmi2EnterInitializationModeTYPE *enter_initialization;
    fmi2ExitInitializationModeTYPE *exit_initialization;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2GetRealTYPE *get_real;
    fmi2DoStepTYPE *do_step;
    fmi2TerminateTYPE *terminate;
    fmi2FreeInstanceTYPE *free_instance;
} fmu;

static void quit(const char *what, const char *which)
{
    fprintf(stderr, "master: %s %s\n", what, which);
    exit(1);
}

/* The attribute of the element that begins at `from`, copied into text. */
static void attribute(const char *from, const char *name, char *text, size_t size)
{
    const char *end = from != NULL ? strchr(from, '>') : NULL;
    const char *begin = from != NULL ? strstr(from, name) : NULL;
    size_t length;

    if (begin == NULL || end == NULL || begin > end) {
        quit("modelDescription.xml: missing", name);
    }
    begin += strlen(name);
    length = strcspn(begin, "\"");
    if (length >= size) {
        quit("modelDescription.xml: too long:", name);
    }
    memcpy(text, begin, length);
    text[length] = '\0';
}

static fmi2ValueReference reference(const char *variable)
{
    char quoted[64], number[16];
    const char *found;

    snprintf(quoted, sizeof quoted, "<ScalarVariable name=\"%s\"", variable);
    found = strstr(description, quoted);
    if (found == NULL) {
        quit("no variable", variable);
    }
    attribute(found, "valueReference=\"", number, sizeof number);
    return (fmi2ValueReference)strtoul(number, NULL, 10);
}

/* Loads a function of the FMU. memcpy, as C has no cast from object to function pointers. */
static void load(const char *name, void *function)
{
    void *symbol = dlsym(library, name);

    if (symbol == NULL) {
        quit("the FMU does not export", name);
    }
    memcpy(function, &symbol, sizeof symbol);
}

static void check(fmi2Status status, const char *call)
{
    if (status > fmi2Warning) {
        quit("failed:", call); /* the message of the FMU went through the logger */
    }
}

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    va_list arguments;

    (void)environment;
    fprintf(stderr, "%s, status %d, %s: ", instance, (int)status, category);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static void read_description(const char *folder)
{
    char path[4096];
    FILE *file;
    long size;

    snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) < 0) {
        quit("cannot read", path);
    }
    rewind(file);
    description = calloc((size_t)size + 1, 1);
    if (description == NULL || fread(description, 1, (size_t)size, file) != (size_t)size) {
        quit("cannot read", path);
    }
    fclose(file);
}

static void load_functions(void)
{
    load("fmi2Instantiate", &fmu.instantiate);
    load("fmi2SetupExperiment", &fmu.setup_experiment);
    load("fmi2EnterInitializationMode", &fmu.enter_initialization);
    load("fmi2ExitInitializationMode", &fmu.exit_initialization);
    load("fmi2SetReal", &fmu.set_real);
    load("fmi2SetInteger", &fmu.set_integer);
    load("fmi2GetReal", &fmu.get_real);
    load("fmi2DoStep", &fmu.do_step);
    load("fmi2Terminate", &fmu.terminate);
    load("fmi2FreeInstance", &fmu.free_instance);
}

/* A new instance, initialised at t = 0. Parameters are set before the initialisation ends. */
static fmi2Component start(void)
{
    static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    const fmi2ValueReference modality = reference("modality"), m = reference("rls.m");
    const fmi2ValueReference P_0 = reference("rls.P_0");
    const fmi2Real P_0_start = 1e28;
    const fmi2Integer sensor = 2, one = 1;
    fmi2Component estimator;
    char guid[64];

    attribute(strstr(description, "<fmiModelDescription"), "guid=\"", guid, sizeof guid);
    estimator =
        fmu.instantiate("estimator", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2False);
    if (estimator == NULL) {
        quit("failed:", "fmi2Instantiate");
    }
    check(fmu.setup_experiment(estimator, fmi2False, 0.0, 0.0, fmi2False, 0.0),
          "fmi2SetupExperiment");
    check(fmu.set_integer(estimator, &modality, 1, &sensor), "modality");
    check(fmu.set_integer(estimator, &m, 1, &one), "rls.m");
    check(fmu.set_real(estimator, &P_0, 1, &P_0_start), "rls.P_0");
    check(fmu.enter_initialization(estimator), "fmi2EnterInitializationMode");
    check(fmu.exit_initialization(estimator), "fmi2ExitInitializationMode");
    return estimator;
}

int main(int argc, char **argv)
{
    const double T = 1e-3, k = 150.0, two_pi = 6.283185307179586;
    const fmi2Real smoother = 1e8;
    fmi2Component estimator;
    fmi2ValueReference inputs[3], sigma, V_a;
    fmi2Real u[3], estimate = 0.0;
    int tick;

    if (argc != 3) {
        quit("usage:", "master FOLDER LIBRARY");
    }
    read_description(argv[1]);
    library = dlopen(argv[2], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        quit("cannot load", dlerror());
    }
    load_functions();
    inputs[0] = reference("theta");
    inputs[1] = reference("q");
    inputs[2] = reference("tau_e_sensor");
    sigma = reference("sigma");
    V_a = reference("filter.V_a");

    estimator = start();
    /* At t_k set what is measured at t_k, then step from t_k to t_k + T: one tick, at t_k. */
    for (tick = 0; tick < 2000; ++tick) {
        const double t = tick * T, phi = 0.01 * sin(two_pi * t);

        u[0] = 0.5 * sin(two_pi * t); /* theta */
        u[1] = u[0] + phi;            /* q */
        u[2] = k * phi;               /* tau_e_sensor */
        if (tick == 1000) {           /* a tunable parameter; it acts from this tick on */
            check(fmu.set_real(estimator, &V_a, 1, &smoother), "filter.V_a");
        }
        check(fmu.set_real(estimator, inputs, 3, u), "fmi2SetReal");
        check(fmu.do_step(estimator, t, T, fmi2True), "fmi2DoStep");
        check(fmu.get_real(estimator, &sigma, 1, &estimate), "fmi2GetReal");
    }
    printf("sigma = %.6f N.m/rad\n", estimate);

    check(fmu.terminate(estimator), "fmi2Terminate");
    fmu.free_instance(estimator);
    free(description);
    dlclose(library);
    return 0;
}
