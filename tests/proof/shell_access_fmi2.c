/* FMI 2.0: a variable of every kind in every function, in arrays of exactly the announced length. */
#include "fmi2Functions.h"
#include "shell_access.h"

static void access(sh_instance *instance, const fmi2ValueReference *vr, size_t n)
{
    fmi2Integer *order = any_bytes(n * sizeof *order);
    fmi2Real *reals = any_bytes(n * sizeof *reals);
    fmi2Integer *integers = any_bytes(n * sizeof *integers);
    fmi2String *strings = any_bytes(n * sizeof *strings);

    fmi2GetReal(instance, vr, n, reals);
    fmi2SetReal(instance, vr, n, reals);
    fmi2GetInteger(instance, vr, n, integers);
    fmi2SetInteger(instance, vr, n, integers);
    fmi2GetBoolean(instance, vr, n, integers);
    fmi2SetBoolean(instance, vr, n, integers);
    fmi2GetString(instance, vr, n, strings);
    fmi2SetString(instance, vr, n, strings);
    fmi2SetRealInputDerivatives(instance, vr, n, order, reals);
    fmi2GetRealOutputDerivatives(instance, vr, n, order, reals);
}

int main(void)
{
    const fmi2ValueReference unknown = (fmi2ValueReference)Frama_C_interval(1000, INT32_MAX);
    sh_instance instance = any_instance();
    size_t i;

    access(NULL, NULL, 0);
    access(&instance, NULL, 0);
    access(&instance, &unknown, 1);
    //@ loop unroll 20;
    for (i = 0; i < sizeof EVERY_KIND / sizeof EVERY_KIND[0]; ++i) {
        const fmi2ValueReference r = EVERY_KIND[i];
        const fmi2ValueReference both[2] = {r, 0};

        access(&instance, &r, 1);
        access(&instance, both, 2);
    }
    return 0;
}
