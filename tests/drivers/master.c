/* A small master for any platform: it steps one FMU with inputs that it reads from stdin.
 *
 * master LIBRARY TOKEN H INPUTS REFERENCE...
 *
 * LIBRARY is the binary of the FMU, of FMI 2.0 or 3.0 as -DSH_FMI=2 or 3 says, TOKEN its GUID, and H
 * the communication step in s. The references are those of the Real inputs, INPUTS of them, then of
 * the Real outputs; arrays are left out. For each row of inputs the FMU makes a step, and a row of
 * outputs goes to stdout with all digits; the first row is that before the first step. Returns 0 if
 * every call returned OK.
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#define OPEN(file) ((void *)LoadLibraryA(file))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)library, name))
#else
#include <dlfcn.h>
#define OPEN(file) dlopen(file, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

#define FUNCTION(name) name##TYPE *name = (name##TYPE *)FIND(library, #name)
#define CHECK(call)                                                                                \
    if ((call) != 0) {                                                                             \
        fprintf(stderr, "not OK: %s\n", #call);                                                    \
        return 1;                                                                                  \
    }

#if SH_FMI == 2

#include "fmi2FunctionTypes.h"

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String message, ...)
{
    va_list arguments;

    (void)environment;
    fprintf(stderr, "%s, %s, status %d: ", name, category, (int)status);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

#define FUNCTIONS                                                                                  \
    FUNCTION(fmi2Instantiate);                                                                     \
    FUNCTION(fmi2SetupExperiment);                                                                 \
    FUNCTION(fmi2EnterInitializationMode);                                                         \
    FUNCTION(fmi2ExitInitializationMode);                                                          \
    FUNCTION(fmi2SetReal);                                                                         \
    FUNCTION(fmi2GetReal);                                                                         \
    FUNCTION(fmi2DoStep);                                                                          \
    FUNCTION(fmi2Terminate);                                                                       \
    FUNCTION(fmi2FreeInstance);                                                                    \
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL}
#define INSTANTIATE(token) fmi2Instantiate("fmu", fmi2CoSimulation, token, "", &callbacks, 0, 0)
#define ENTER(fmu)                                                                                 \
    (fmi2SetupExperiment(fmu, 0, 0, 0, 0, 0) != fmi2OK ? fmi2Error                                 \
                                                       : fmi2EnterInitializationMode(fmu))
#define EXIT fmi2ExitInitializationMode
#define GET fmi2GetReal
#define SET fmi2SetReal
#define STEP(fmu, t, h) fmi2DoStep(fmu, t, h, 1)
#define TERMINATE fmi2Terminate
#define FREE fmi2FreeInstance

#else

#include "fmi3FunctionTypes.h"

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message)
{
    (void)environment;
    fprintf(stderr, "%s, status %d: %s\n", category, (int)status, message);
}

#define FUNCTIONS                                                                                  \
    FUNCTION(fmi3InstantiateCoSimulation);                                                         \
    FUNCTION(fmi3EnterInitializationMode);                                                         \
    FUNCTION(fmi3ExitInitializationMode);                                                          \
    FUNCTION(fmi3SetFloat64);                                                                      \
    FUNCTION(fmi3GetFloat64);                                                                      \
    FUNCTION(fmi3DoStep);                                                                          \
    FUNCTION(fmi3Terminate);                                                                       \
    FUNCTION(fmi3FreeInstance);                                                                    \
    fmi3Boolean event, terminate, early;                                                           \
    double reached
#define INSTANTIATE(token)                                                                         \
    fmi3InstantiateCoSimulation("fmu", token, "", 0, 0, 0, 0, NULL, 0, NULL, log_message, NULL)
#define ENTER(fmu) fmi3EnterInitializationMode(fmu, 0, 0, 0, 0, 0)
#define EXIT fmi3ExitInitializationMode
#define GET(fmu, references, n, values) fmi3GetFloat64(fmu, references, n, values, n)
#define SET(fmu, references, n, values) fmi3SetFloat64(fmu, references, n, values, n)
#define STEP(fmu, t, h) fmi3DoStep(fmu, t, h, 1, &event, &terminate, &early, &reached)
#define TERMINATE fmi3Terminate
#define FREE fmi3FreeInstance

#endif

enum { MAX_VARIABLES = 256 };

int main(int argc, char **argv)
{
    const size_t inputs = argc > 4 ? strtoul(argv[4], NULL, 10) : 0;
    const size_t variables = argc > 5 ? (size_t)argc - 5 : 0, outputs = variables - inputs;
    const double h = argc > 3 ? strtod(argv[3], NULL) : 0;
    unsigned references[MAX_VARIABLES]; /* the type of both versions */
    double values[MAX_VARIABLES];
    void *library, *fmu;
    size_t i;
    long step;

    if (variables > MAX_VARIABLES || inputs == 0 || inputs >= variables) {
        fprintf(stderr, "expected: master LIBRARY TOKEN H INPUTS REFERENCE...\n");
        return 1;
    }
    for (i = 0; i < variables; ++i) {
        references[i] = (unsigned)strtoul(argv[5 + i], NULL, 10);
    }
    library = OPEN(argv[1]);
    if (library == NULL) {
        fprintf(stderr, "%s cannot be loaded\n", argv[1]);
        return 1;
    }
    FUNCTIONS;
    fmu = INSTANTIATE(argv[2]);
    if (fmu == NULL) {
        return 1;
    }
    CHECK(ENTER(fmu));
    CHECK(EXIT(fmu));
    for (step = 0;; ++step) {
        CHECK(GET(fmu, references + inputs, outputs, values));
        for (i = 0; i < outputs; ++i) {
            printf("%.17g%c", values[i], i + 1 < outputs ? ',' : '\n');
        }
        for (i = 0; i < inputs && scanf("%lf,", values + i) == 1; ++i)
            ;
        if (i < inputs) {
            break;
        }
        CHECK(SET(fmu, references, inputs, values));
        CHECK(STEP(fmu, (double)step * h, h));
    }
    CHECK(TERMINATE(fmu));
    FREE(fmu);
    return 0;
}
