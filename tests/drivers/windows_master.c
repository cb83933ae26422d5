/* A small master for Windows: it steps one FMU with inputs that it reads from stdin.
 *
 * windows_master LIBRARY GUID H INPUTS REFERENCE...
 *
 * LIBRARY is the binary of the FMU, H the communication step in s. The references are those
 * of the Real inputs, INPUTS of them, then of the Real outputs. For each row of inputs the
 * FMU makes a step, and a row of outputs goes to stdout with all digits; the first row is
 * that before the first step. Returns 0 if every call returned fmi2OK.
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

#include "fmi2FunctionTypes.h"

enum { MAX_VARIABLES = 256 };

#define FUNCTION(name) name##TYPE *name = (name##TYPE *)(void *)GetProcAddress(library, #name)
#define CHECK(call)                                                                                \
    if ((call) != fmi2OK) {                                                                        \
        fprintf(stderr, "not fmi2OK: %s\n", #call);                                                \
        return 1;                                                                                  \
    }

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

int main(int argc, char **argv)
{
    const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
    const size_t inputs = argc > 4 ? strtoul(argv[4], NULL, 10) : 0;
    const size_t variables = argc > 5 ? (size_t)argc - 5 : 0;
    const size_t outputs = variables - inputs;
    const double h = argc > 3 ? strtod(argv[3], NULL) : 0;
    fmi2ValueReference references[MAX_VARIABLES];
    double values[MAX_VARIABLES];
    size_t i;
    long step;

    if (variables > MAX_VARIABLES || inputs == 0 || inputs >= variables) {
        fprintf(stderr, "expected: windows_master LIBRARY GUID H INPUTS REFERENCE...\n");
        return 1;
    }
    for (i = 0; i < variables; ++i) {
        references[i] = (fmi2ValueReference)strtoul(argv[5 + i], NULL, 10);
    }

    HMODULE library = LoadLibraryA(argv[1]);

    if (library == NULL) {
        fprintf(stderr, "%s cannot be loaded\n", argv[1]);
        return 1;
    }
    FUNCTION(fmi2Instantiate);
    FUNCTION(fmi2SetupExperiment);
    FUNCTION(fmi2EnterInitializationMode);
    FUNCTION(fmi2ExitInitializationMode);
    FUNCTION(fmi2SetReal);
    FUNCTION(fmi2GetReal);
    FUNCTION(fmi2DoStep);
    FUNCTION(fmi2Terminate);
    FUNCTION(fmi2FreeInstance);

    const fmi2Component c =
        fmi2Instantiate("fmu", fmi2CoSimulation, argv[2], "", &callbacks, fmi2False, fmi2False);

    if (c == NULL) {
        return 1;
    }
    CHECK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0));
    CHECK(fmi2EnterInitializationMode(c));
    CHECK(fmi2ExitInitializationMode(c));
    for (step = 0;; ++step) {
        CHECK(fmi2GetReal(c, references + inputs, outputs, values));
        for (i = 0; i < outputs; ++i) {
            printf("%.17g%c", values[i], i + 1 < outputs ? ',' : '\n');
        }
        for (i = 0; i < inputs && scanf("%lf,", values + i) == 1; ++i)
            ;
        if (i < inputs) {
            break;
        }
        CHECK(fmi2SetReal(c, references, inputs, values));
        CHECK(fmi2DoStep(c, (double)step * h, h, fmi2True));
    }
    CHECK(fmi2Terminate(c));
    fmi2FreeInstance(c);
    return 0;
}
