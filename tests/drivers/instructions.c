/* instructions METHOD: steps of an FMU, whose instructions tests/project/test_instructions.py counts.
 *
 * METHOD is that of an estimator; a plant ignores it.
 */
#include <stdlib.h>
#include <string.h>

#include "drive.h"

enum { STEPS = 600 };

int main(int argc, char **argv)
{
    const fmi2Integer method = argc == 2 ? atoi(argv[1]) : 0;
    double outputs[256];
    void *instance = fmi_instantiate(sh_fmu_model.guid);
    uint32_t i;
    long k;

    check(instance != NULL, "instantiate");
    for (i = 0; i < sh_fmu_model.count; ++i) {
        if (strcmp(sh_fmu_model.variables[i].name, "method") == 0) {
            check(fmi2SetInteger(instance, &i, 1, &method) == fmi2OK, "set the method");
        }
    }
    fmi_initialize(instance);
    for (k = 0; k < STEPS; ++k) {
        step(instance, 0, k);
        get_outputs(instance, outputs);
    }
    fmi_free_instance(instance);
    return 0;
}
