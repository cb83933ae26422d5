/* Co-simulation master in plain C for StiffnessEstimator.fmu, see docs/how-to/c-master.md.
 *
 * The call is `master FOLDER LIBRARY`, with the folder of the unpacked FMU and its shared library. The program
 * simulates a joint with a spring of 150 N.m/rad, whose motor torque is measured. Motor and link oscillate for three
 * seconds, and the estimator, FilteredRegression, receives the measurements. At the end the program prints the
 * stiffness, its standard deviation, and whether the estimator is confident.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

/* Data of the motor: gear ratio [1], inertia [kg.m2], viscous friction [N.m.s/rad]. */
#define GEAR 50.0
#define INERTIA 2.3e-5
#define FRICTION 1e-3

static char *description; /* text of modelDescription.xml */
static void *library;

/* Pointers to all functions of the FMU that this program calls. */
static struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2SetupExperimentTYPE *setup_experiment;
    fmi2EnterInitializationModeTYPE *enter_initialization;
    fmi2ExitInitializationModeTYPE *exit_initialization;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2GetRealTYPE *get_real;
    fmi2GetBooleanTYPE *get_boolean;
    fmi2DoStepTYPE *do_step;
    fmi2TerminateTYPE *terminate;
    fmi2FreeInstanceTYPE *free_instance;
} fmu;

static void quit(const char *what, const char *which)
{
    fprintf(stderr, "master: %s %s\n", what, which);
    exit(1);
}

/* Copies the value of an attribute into `text`; the XML element begins at `from`. */
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

/* Loads a function of the FMU. C cannot cast object pointers to function pointers, so memcpy copies the pointer. */
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
        quit("failed:", call); /* the logger has already printed the message of the FMU */
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
    load("fmi2GetBoolean", &fmu.get_boolean);
    load("fmi2DoStep", &fmu.do_step);
    load("fmi2Terminate", &fmu.terminate);
    load("fmi2FreeInstance", &fmu.free_instance);
}

static void set_real(fmi2Component estimator, const char *parameter, fmi2Real value)
{
    const fmi2ValueReference which = reference(parameter);

    check(fmu.set_real(estimator, &which, 1, &value), parameter);
}

static void set_integer(fmi2Component estimator, const char *parameter, fmi2Integer value)
{
    const fmi2ValueReference which = reference(parameter);

    check(fmu.set_integer(estimator, &which, 1, &value), parameter);
}

/* Creates an instance of the FMU and initialises it at t = 0. Parameters must be set before the initialisation ends. */
static fmi2Component start(void)
{
    static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
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
    set_integer(estimator, "method", 2); /* FilteredRegression */
    set_integer(estimator, "rls.m", 1);  /* no motor sets the stiffness */
    set_real(estimator, "motor.gamma", GEAR);
    set_real(estimator, "motor.B", INERTIA);
    set_real(estimator, "motor.D_theta", FRICTION);
    set_real(estimator, "range.phi", 0.015);   /* largest deformation [rad] */
    set_real(estimator, "prior.tau_e", 2.5);   /* largest torque of the spring [N.m] */
    set_real(estimator, "encoder.theta", 0.0); /* these positions are not rounded */
    set_real(estimator, "encoder.q", 0.0);
    check(fmu.enter_initialization(estimator), "fmi2EnterInitializationMode");
    check(fmu.exit_initialization(estimator), "fmi2ExitInitializationMode");
    return estimator;
}

int main(int argc, char **argv)
{
    const double T = 1e-3, k = 150.0, w = 6.283185307179586, v = 1.7 * w;
    fmi2Component estimator;
    fmi2ValueReference inputs[3], outputs[2], confident;
    fmi2Real u[3], found[2] = {0.0, 0.0};
    fmi2Boolean is_confident = fmi2False;
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
    inputs[2] = reference("tau");
    outputs[0] = reference("sigma");
    outputs[1] = reference("sigma_std");
    confident = reference("confident");

    estimator = start();
    /* Each iteration sets the measurements of time t_k, then makes a step from t_k to t_k + T with one tick at t_k. */
    for (tick = 0; tick < 3000; ++tick) {
        const double t = tick * T, phi = 0.01 * sin(v * t);

        u[0] = 0.5 * sin(w * t); /* theta */
        u[1] = u[0] + phi;       /* q */
        u[2] = GEAR * (FRICTION * 0.5 * w * cos(w * t) - INERTIA * 0.5 * w * w * sin(w * t)) -
               k * phi / GEAR; /* tau, from the motor equation (3) of the paper */
        if (tick == 1000) {    /* a tunable parameter acts from the next tick on */
            set_real(estimator, "limit.relative_std", 0.05);
        }
        check(fmu.set_real(estimator, inputs, 3, u), "fmi2SetReal");
        check(fmu.do_step(estimator, t, T, fmi2True), "fmi2DoStep");
        check(fmu.get_real(estimator, outputs, 2, found), "fmi2GetReal");
        check(fmu.get_boolean(estimator, &confident, 1, &is_confident), "fmi2GetBoolean");
    }
    printf("sigma = %.1f +- %.1f N.m/rad, %s\n", found[0], 1.96 * found[1],
           is_confident ? "confident" : "not confident");

    check(fmu.terminate(estimator), "fmi2Terminate");
    fmu.free_instance(estimator);
    free(description);
    dlclose(library);
    return 0;
}
