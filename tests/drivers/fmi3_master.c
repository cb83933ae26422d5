/* A small master for FMI 3.0, for any platform: it steps one FMU with inputs that it reads from stdin.
 *
 * fmi3_master LIBRARY TOKEN H INPUTS REFERENCE...
 *
 * As windows_master, with arrays left out: the references are those of the Float64 inputs, INPUTS of
 * them, then of the Float64 outputs. Returns 0 if every call returned fmi3OK.
 */
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

#include "fmi3FunctionTypes.h"

enum { MAX_VARIABLES = 256 };

#define FUNCTION(name) name##TYPE *name = (name##TYPE *)FIND(library, #name)
#define CHECK(call)                                                                                \
    if ((call) != fmi3OK) {                                                                        \
        fprintf(stderr, "not fmi3OK: %s\n", #call);                                                \
        return 1;                                                                                  \
    }

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message)
{
    (void)environment;
    fprintf(stderr, "%s, status %d: %s\n", category, (int)status, message);
}

int main(int argc, char **argv)
{
    const size_t inputs = argc > 4 ? strtoul(argv[4], NULL, 10) : 0;
    const size_t variables = argc > 5 ? (size_t)argc - 5 : 0;
    const size_t outputs = variables - inputs;
    const double h = argc > 3 ? strtod(argv[3], NULL) : 0;
    fmi3ValueReference references[MAX_VARIABLES];
    double values[MAX_VARIABLES], reached;
    fmi3Boolean event, terminate, early;
    void *library;
    size_t i;
    long step;

    if (variables > MAX_VARIABLES || inputs == 0 || inputs >= variables) {
        fprintf(stderr, "expected: fmi3_master LIBRARY TOKEN H INPUTS REFERENCE...\n");
        return 1;
    }
    for (i = 0; i < variables; ++i) {
        references[i] = (fmi3ValueReference)strtoul(argv[5 + i], NULL, 10);
    }
    library = OPEN(argv[1]);
    if (library == NULL) {
        fprintf(stderr, "%s cannot be loaded\n", argv[1]);
        return 1;
    }
    FUNCTION(fmi3InstantiateCoSimulation);
    FUNCTION(fmi3EnterInitializationMode);
    FUNCTION(fmi3ExitInitializationMode);
    FUNCTION(fmi3SetFloat64);
    FUNCTION(fmi3GetFloat64);
    FUNCTION(fmi3DoStep);
    FUNCTION(fmi3Terminate);
    FUNCTION(fmi3FreeInstance);

    const fmi3Instance fmu =
        fmi3InstantiateCoSimulation("fmu", argv[2], "", fmi3False, fmi3False, fmi3False, fmi3False,
                                    NULL, 0, NULL, log_message, NULL);

    if (fmu == NULL) {
        return 1;
    }
    CHECK(fmi3EnterInitializationMode(fmu, fmi3False, 0, 0, fmi3False, 0));
    CHECK(fmi3ExitInitializationMode(fmu));
    for (step = 0;; ++step) {
        CHECK(fmi3GetFloat64(fmu, references + inputs, outputs, values, outputs));
        for (i = 0; i < outputs; ++i) {
            printf("%.17g%c", values[i], i + 1 < outputs ? ',' : '\n');
        }
        for (i = 0; i < inputs && scanf("%lf,", values + i) == 1; ++i)
            ;
        if (i < inputs) {
            break;
        }
        CHECK(fmi3SetFloat64(fmu, references, inputs, values, inputs));
        CHECK(fmi3DoStep(fmu, (double)step * h, h, fmi3True, &event, &terminate, &early, &reached));
    }
    CHECK(fmi3Terminate(fmu));
    fmi3FreeInstance(fmu);
    return 0;
}
