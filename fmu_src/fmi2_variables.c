/* FMI 2.0: reading and writing variables through the generated table. */
#include <math.h>

#include "instance.h"

/* The variable of a reference, or NULL after a message. */
static const sh_variable *find(sh_instance *instance, fmi2ValueReference reference, sh_type type,
                               const char *function)
{
    static const char *const TYPES[] = {"Real", "Integer or Enumeration", "Boolean"};
    const sh_variable *variable;

    if (reference >= sh_fmu_model.count) {
        sh_log(instance, fmi2Error, "%s: unknown value reference %u; the last one is %u.", function,
               reference, (unsigned)sh_fmu_model.count - 1);
        return NULL;
    }
    variable = &sh_fmu_model.variables[reference];
    if (variable->type != type) {
        sh_log(instance, fmi2Error, "%s: value reference %u is %s, which is %s.", function,
               reference, variable->name, TYPES[variable->type]);
        return NULL;
    }
    return variable;
}

static int may_be_set(sh_instance *instance, const sh_variable *variable, const char *function)
{
    static const struct {
        unsigned states;
        const char *rule;
    } RULES[] = {
        {SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, "an input"},
        {0, "an output"},
        {SH_INSTANTIATED, "an output"}, /* a guess of its initial value, overwritten */
        {SH_INSTANTIATED | SH_INITIALIZATION,
         "a fixed parameter, settable until the end of initialisation"},
        {SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, "a tunable parameter"},
    };

    if ((unsigned)instance->state & RULES[variable->role].states)
        return 1;
    sh_log(instance, fmi2Error, "%s: %s cannot be set now: it is %s.", function, variable->name,
           RULES[variable->role].rule);
    return 0;
}

/* The checks common to all readers. Initial outputs follow what was set so far. */
static sh_instance *enter_get(fmi2Component c, size_t count, const void *references,
                              const void *values, const char *function)
{
    sh_instance *instance = sh_enter(c, SH_INITIALIZATION | SH_STEP | SH_TERMINATED, function);

    if (instance == NULL || (count > 0 && (!sh_has(instance, references, function, "vr") ||
                                           !sh_has(instance, values, function, "value"))))
        return NULL;
    if (instance->state == SH_INITIALIZATION && sh_initialize(instance) != fmi2OK)
        return NULL;
    return instance;
}

static sh_instance *enter_set(fmi2Component c, size_t count, const void *references,
                              const void *values, sh_type type, const char *function)
{
    sh_instance *instance = sh_enter(c, SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, function);
    size_t i;

    if (instance == NULL || (count > 0 && (!sh_has(instance, references, function, "vr") ||
                                           !sh_has(instance, values, function, "value"))))
        return NULL;
    /* All or none: check every reference before the first value is written. */
    for (i = 0; i < count; ++i) {
        const sh_variable *variable =
            find(instance, ((const fmi2ValueReference *)references)[i], type, function);
        if (variable == NULL || !may_be_set(instance, variable, function))
            return NULL;
        if (variable->role == SH_ROLE_FIXED || variable->role == SH_ROLE_TUNABLE)
            instance->parameters_unchecked = 1;
    }
    if (instance->state == SH_INITIALIZATION)
        instance->outputs_stale = 1;
    return instance;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    sh_instance *instance = enter_get(c, nvr, vr, value, "fmi2GetReal");
    size_t i;

    if (instance == NULL)
        return fmi2Error;
    for (i = 0; i < nvr; ++i) {
        const sh_variable *variable = find(instance, vr[i], SH_TYPE_REAL, "fmi2GetReal");
        if (variable == NULL)
            return fmi2Error;
        value[i] = *(const double *)(const void *)((char *)instance->model + variable->offset);
    }
    return fmi2OK;
}

static fmi2Status get_int(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, int value[],
                          sh_type type, const char *function)
{
    sh_instance *instance = enter_get(c, nvr, vr, value, function);
    size_t i;

    if (instance == NULL)
        return fmi2Error;
    for (i = 0; i < nvr; ++i) {
        const sh_variable *variable = find(instance, vr[i], type, function);
        if (variable == NULL)
            return fmi2Error;
        value[i] = *(const int *)(const void *)((char *)instance->model + variable->offset);
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Integer value[])
{
    return get_int(c, vr, nvr, value, SH_TYPE_INTEGER, "fmi2GetInteger");
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Boolean value[])
{
    return get_int(c, vr, nvr, value, SH_TYPE_BOOLEAN, "fmi2GetBoolean");
}

/* No FMU of this project has a variable of type String. */
static fmi2Status no_strings(sh_instance *instance, size_t nvr, const char *function)
{
    if (instance == NULL)
        return fmi2Error;
    if (nvr == 0)
        return fmi2OK;
    sh_log(instance, fmi2Error, "%s: %s has no variables of type String.", function,
           sh_fmu_model.identifier);
    return fmi2Error;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         fmi2String value[])
{
    return no_strings(enter_get(c, nvr, vr, value, "fmi2GetString"), nvr, "fmi2GetString");
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                       const fmi2Real value[])
{
    sh_instance *instance = enter_set(c, nvr, vr, value, SH_TYPE_REAL, "fmi2SetReal");
    size_t i;

    if (instance == NULL)
        return fmi2Error;
    for (i = 0; i < nvr; ++i) {
        const size_t offset = sh_fmu_model.variables[vr[i]].offset;
        *(double *)(void *)((char *)instance->model + offset) = value[i];
    }
    return fmi2OK;
}

static fmi2Status set_int(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const int value[], sh_type type, const char *function)
{
    sh_instance *instance = enter_set(c, nvr, vr, value, type, function);
    size_t i;

    if (instance == NULL)
        return fmi2Error;
    for (i = 0; i < nvr; ++i) {
        const size_t offset = sh_fmu_model.variables[vr[i]].offset;
        *(int *)(void *)((char *)instance->model + offset) = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    return set_int(c, vr, nvr, value, SH_TYPE_INTEGER, "fmi2SetInteger");
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    return set_int(c, vr, nvr, value, SH_TYPE_BOOLEAN, "fmi2SetBoolean");
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2String value[])
{
    sh_instance *instance =
        sh_enter(c, SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, "fmi2SetString");

    (void)vr;
    (void)value;
    return no_strings(instance, nvr, "fmi2SetString");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    static const char function[] = "fmi2SetRealInputDerivatives";
    sh_instance *instance = enter_set(c, nvr, vr, value, SH_TYPE_REAL, function);
    size_t i;

    if (instance == NULL || (nvr > 0 && !sh_has(instance, order, function, "order")))
        return fmi2Error;
    for (i = 0; i < nvr; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[vr[i]];
        if (variable->role != SH_ROLE_INPUT) {
            sh_log(instance, fmi2Error, "%s: %s is not an input.", function, variable->name);
            return fmi2Error;
        }
        if (order[i] != 1) {
            sh_log(instance, fmi2Error, "%s: order %d of %s is not supported; expected 1.",
                   function, order[i], variable->name);
            return fmi2Error;
        }
    }
    instance->slopes_set = 1;
    for (i = 0; i < nvr; ++i) {
        const size_t offset = sh_fmu_model.variables[vr[i]].offset + sh_fmu_model.derivative_offset;
        *(double *)(void *)((char *)instance->model + offset) = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    sh_instance *instance = sh_enter(c, SH_STEP | SH_TERMINATED, "fmi2GetRealOutputDerivatives");

    (void)vr;
    (void)order;
    (void)value;
    if (instance == NULL)
        return fmi2Error;
    if (nvr == 0)
        return fmi2OK;
    sh_log(instance, fmi2Error,
           "fmi2GetRealOutputDerivatives: not provided (maxOutputDerivativeOrder is 0).");
    return fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[],
                                        size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    sh_instance *instance =
        sh_enter(c, SH_INITIALIZATION | SH_STEP | SH_TERMINATED, "fmi2GetDirectionalDerivative");

    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    if (instance != NULL)
        sh_log(instance, fmi2Error,
               "fmi2GetDirectionalDerivative: not provided "
               "(providesDirectionalDerivative is false).");
    return fmi2Error;
}
