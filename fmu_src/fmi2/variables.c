/* Functions of FMI 2.0 that read and write variables. */
#include "access.h"
#include "fmi2Functions.h"
#include "guards.h"

/* Describes a call of the importer that passes one value for each value reference. */
#define CALL(function, types, type_of_values)                                                      \
    const sh_access access = {c, function, types, type_of_values, 0, vr, nvr, nvr}

#define ACCESS(Type, TYPES, VALUES)                                                                \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             fmi2##Type value[])                                                   \
    {                                                                                              \
        CALL("fmi2Get" #Type, TYPES, VALUES);                                                      \
        return (fmi2Status)sh_get(&access, (void *)value);                                         \
    }                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             const fmi2##Type value[])                                             \
    {                                                                                              \
        CALL("fmi2Set" #Type, TYPES, VALUES);                                                      \
        return (fmi2Status)sh_set(&access, (const void *)value);                                   \
    }

ACCESS(Real, SH_TYPE_REAL, SH_DOUBLES)
ACCESS(Integer, SH_TYPE_INTEGER | SH_TYPE_ENUMERATION, SH_INTS)
ACCESS(Boolean, SH_TYPE_BOOLEAN, SH_INTS)
ACCESS(String, 0,
       SH_BYTES) /* no FMU of this project has a String variable, so any reference is an error */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    CALL("fmi2SetRealInputDerivatives", SH_TYPE_REAL, SH_DOUBLES);
    sh_instance *instance = sh_begin_set(&access, value);
    const sh_variable *variables = sh_fmu_model.variables;
    size_t i;

    if (instance == NULL || (nvr > 0 && !sh_has(instance, order, access.function, "order"))) {
        return fmi2Error;
    }
    for (i = 0; i < nvr; ++i) {
        const sh_variable *variable = &variables[vr[i]];
        if (variable->role != SH_ROLE_INPUT) {
            sh_report(instance, SH_ERROR, "%s: %s is not an input.", access.function,
                      variable->name);
            return fmi2Error;
        }
        if (order[i] != 1) {
            sh_report(instance, SH_ERROR, "%s: order %d of %s is not supported; expected 1.",
                      access.function, order[i], variable->name);
            return fmi2Error;
        }
    }
    for (i = 0; i < nvr; ++i) {
        instance->slopes_end = vr[i] < instance->slopes_end ? instance->slopes_end : vr[i] + 1;
        *sh_slope(instance, &variables[vr[i]]) = value[i];
    }
    return fmi2OK;
}
