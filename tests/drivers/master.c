/* A small master for any platform: it steps the FMU that it is linked with, with inputs from stdin.
 *
 * master TOKEN H INPUTS REFERENCE...
 *
 * TOKEN is the GUID of the FMU, and H the communication step in s. The references are those of the
 * Real inputs, INPUTS of them, then of the Real outputs; arrays are left out. For each row of inputs the FMU makes a
 * step, and a row of outputs goes to stdout with all digits. The first row has the outputs before the first step.
 * Returns 0 if every call returned OK.
 */
#include <stdio.h>

#include "fmi_calls.h"

enum { MAX_VARIABLES = 256 };

int main(int argc, char **argv)
{
    const size_t inputs = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;
    const size_t variables = argc > 4 ? (size_t)argc - 4 : 0, outputs = variables - inputs;
    const double h = argc > 2 ? strtod(argv[2], NULL) : 0.0;
    uint32_t references[MAX_VARIABLES];
    double values[MAX_VARIABLES];
    void *fmu;
    size_t i;
    long step;

    check(variables <= MAX_VARIABLES && inputs > 0 && inputs < variables,
          "expected: master TOKEN H INPUTS REFERENCE...");
    for (i = 0; i < variables; ++i) {
        references[i] = (uint32_t)strtoul(argv[4 + i], NULL, 10);
    }
    fmu = fmi_instantiate(argv[1]);
    check(fmu != NULL, "instantiate");
    fmi_initialize(fmu);
    for (step = 0;; ++step) {
        check(fmi_get_reals(fmu, references + inputs, outputs, values) == SH_OK, "get the outputs");
        for (i = 0; i < outputs; ++i) {
            printf("%.17g%c", values[i], i + 1 < outputs ? ',' : '\n');
        }
        for (i = 0; i < inputs && scanf("%lf,", values + i) == 1; ++i)
            ;
        if (i < inputs) {
            break;
        }
        check(fmi_set_reals(fmu, references, inputs, values) == SH_OK, "set the inputs");
        check(fmi_do_step(fmu, (double)step * h, h) == SH_OK, "step");
    }
    check(fmi_terminate(fmu) == SH_OK, "terminate");
    fmi_free_instance(fmu);
    return 0;
}
