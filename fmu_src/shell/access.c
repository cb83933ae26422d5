#include "access.h"

#include <math.h>
#include <stdio.h>

const sh_variable *sh_find(const sh_access *access, uint32_t reference)
{
    const sh_variable *variable;

    if (access->arrays && reference == sh_fmu_model.count) {
        sh_log(access->handle, SH_ERROR,
               "%s: value reference %lu is time, which can only be read, as Float64.",
               access->function, (unsigned long)reference);
        return NULL;
    }
    if (reference >= sh_fmu_model.count) {
        sh_log(access->handle, SH_ERROR, "%s: unknown value reference %lu; the last one is %lu.",
               access->function, (unsigned long)reference, (unsigned long)sh_fmu_model.count - 1);
        return NULL;
    }
    variable = &sh_fmu_model.variables[reference];
    if (!((unsigned)variable->type & access->types)) {
        sh_log(access->handle, SH_ERROR, "%s: value reference %lu is %s, which is %s.",
               access->function, (unsigned long)reference, variable->name,
               sh_type_name(variable->type));
        return NULL;
    }
    if (access->arrays && variable->length == 0) {
        sh_log(access->handle, SH_ERROR,
               "%s: value reference %lu is %s, an element; expected that of the array.",
               access->function, (unsigned long)reference, variable->name);
        return NULL;
    }
    return variable;
}

static int may_be_set(const sh_access *access, const sh_variable *variable)
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
    sh_instance *instance = access->handle;

    if ((unsigned)instance->state & RULES[variable->role].states)
        return 1;
    sh_log(instance, SH_ERROR, "%s: %s cannot be set now: it is %s.", access->function,
           variable->name, RULES[variable->role].rule);
    return 0;
}

/* The checks common to reading and writing. */
static sh_instance *begin(const sh_access *access, unsigned states, const uint32_t references[],
                          size_t count, const void *values)
{
    sh_instance *instance = sh_enter(access->handle, states, access->function);

    if (instance == NULL ||
        (count > 0 && (!sh_has(instance, references, access->function, "valueReferences") ||
                       !sh_has(instance, values, access->function, "values"))))
        return NULL;
    return instance;
}

sh_instance *sh_begin_get(const sh_access *access, const uint32_t references[], size_t count,
                          const void *values)
{
    /* With arrays, FMI 3.0, start values can be read from the begin. */
    const unsigned states =
        SH_INITIALIZATION | SH_STEP | SH_TERMINATED | (access->arrays ? SH_INSTANTIATED : 0);
    sh_instance *instance = begin(access, states, references, count, values);

    if (instance == NULL ||
        (instance->state == SH_INITIALIZATION && sh_initialize(instance) != SH_OK))
        return NULL;
    return instance;
}

sh_instance *sh_begin_set(const sh_access *access, const uint32_t references[], size_t count,
                          const void *values)
{
    sh_instance *instance =
        begin(access, SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, references, count, values);
    size_t i;

    if (instance == NULL)
        return NULL;
    for (i = 0; i < count; ++i) {
        const sh_variable *variable = sh_find(access, references[i]);
        if (variable == NULL || !may_be_set(access, variable))
            return NULL;
        if (variable->role == SH_ROLE_FIXED || variable->role == SH_ROLE_TUNABLE)
            instance->parameters_unchecked = 1;
    }
    if (instance->state == SH_INITIALIZATION)
        instance->outputs_stale = 1;
    return instance;
}

/* Writes the allowed range of a variable, "[0, 1]" or "(-inf, inf)". */
static void write_range(char *text, size_t size, const sh_variable *variable)
{
    snprintf(text, size, "%c%.9g, %.9g%c", isfinite(variable->min) ? '[' : '(', variable->min,
             variable->max, isfinite(variable->max) ? ']' : ')');
}

static int in_range(const sh_variable *variable, double value)
{
    return isfinite(value) && value >= variable->min && value <= variable->max;
}

int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function)
{
    char range[64];

    if ((variable->role != SH_ROLE_FIXED && variable->role != SH_ROLE_TUNABLE) ||
        in_range(variable, value))
        return 1;
    write_range(range, sizeof range, variable);
    sh_log(instance, SH_ERROR, "%s: parameter %s = %.9g is out of its range %s.", function,
           variable->name, value, range);
    return 0;
}

static void *place_of_variable(const sh_instance *instance, const sh_variable *variable)
{
    return (char *)instance->model + variable->offset;
}

double sh_read(const sh_instance *instance, const sh_variable *variable)
{
    const void *place = place_of_variable(instance, variable);

    return variable->type == SH_TYPE_REAL ? *(const double *)place : (double)*(const int *)place;
}

void sh_write(sh_instance *instance, const sh_variable *variable, double value)
{
    void *place = place_of_variable(instance, variable);

    if (variable->type == SH_TYPE_REAL)
        *(double *)place = value;
    else
        *(int *)place = (int)value;
}

double *sh_slope(sh_instance *instance, const sh_variable *input)
{
    return (double *)(void *)((char *)instance->model + input->offset +
                              sh_fmu_model.derivative_offset);
}
