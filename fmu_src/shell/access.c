#include "access.h"

#include "value.h"

/* Time, the independent variable of FMI 3.0: it has the reference after those of the table. */
static int is_time(const sh_access *access, uint32_t reference)
{
    return access->arrays && reference == sh_fmu_model.count;
}

/* The variable of a reference, or the first one of its array; NULL after a message. */
static const sh_variable *find(const sh_access *access, uint32_t reference)
{
    const sh_variable *variable;

    if (is_time(access, reference)) {
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

    if ((unsigned)instance->state & RULES[variable->role].states) {
        return 1;
    }
    sh_log(instance, SH_ERROR, "%s: %s cannot be set now: it is %s.", access->function,
           variable->name, RULES[variable->role].rule);
    return 0;
}

/* Number of elements that a reference means. */
static size_t length_of(const sh_access *access, const sh_variable *variable)
{
    return access->arrays ? variable->length : 1;
}

/* The checks common to reading and writing: the arguments, and the number of elements behind the
 * references.
 */
static sh_instance *begin(const sh_access *access, unsigned states, const void *values,
                          int time_allowed)
{
    sh_instance *instance = sh_enter(access->handle, states, access->function);
    size_t elements = 0, i;

    if (instance == NULL ||
        (access->count > 0 &&
         (!sh_has(instance, access->references, access->function, "valueReferences") ||
          !sh_has(instance, values, access->function, "values")))) {
        return NULL;
    }
    for (i = 0; i < access->count; ++i) {
        const uint32_t reference = access->references[i];
        const sh_variable *variable;

        if (time_allowed && is_time(access, reference)) {
            elements += 1;
            continue;
        }
        variable = find(access, reference);
        if (variable == NULL) {
            return NULL;
        }
        elements += length_of(access, variable);
    }
    if (elements == access->length) {
        return instance;
    }
    sh_log(instance, SH_ERROR,
           "%s: nValues = %lu; expected %lu, the number of elements behind %lu references.",
           access->function, (unsigned long)access->length, (unsigned long)elements,
           (unsigned long)access->count);
    return NULL;
}

sh_instance *sh_begin_set(const sh_access *access, const void *values)
{
    sh_instance *instance = begin(access, SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, values, 0);
    size_t i;

    if (instance == NULL) {
        return NULL;
    }
    for (i = 0; i < access->count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[access->references[i]];
        if (!may_be_set(access, variable)) {
            return NULL;
        }
        if (sh_is_parameter(variable)) {
            instance->parameters_unchecked = 1;
        }
    }
    if (instance->state == SH_INITIALIZATION) {
        instance->outputs_stale = 1;
    }
    return instance;
}

sh_status sh_get(const sh_access *access, void *values, sh_store *store)
{
    /* FMI 3.0 lets importers read start values before the initialisation. */
    const unsigned states =
        SH_INITIALIZATION | SH_STEP | SH_TERMINATED | (access->arrays ? SH_INSTANTIATED : 0);
    sh_instance *instance = begin(access, states, values, access->types == SH_TYPE_REAL);
    size_t i, k, next = 0;

    if (instance == NULL ||
        (instance->state == SH_INITIALIZATION && sh_initialize(instance) != SH_OK)) {
        return SH_ERROR;
    }
    if (store == NULL) {
        return SH_OK;
    }
    /* `begin` has counted: the importer's array ends with the last reference. */
    for (i = 0; i < access->count && next < access->length; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[access->references[i]];
        if (is_time(access, access->references[i])) {
            store(values, next++, instance->time);
        } else {
            for (k = 0; k < length_of(access, first) && next < access->length; ++k) {
                store(values, next++, sh_read(instance, first + k));
            }
        }
    }
    return SH_OK;
}

sh_status sh_set(const sh_access *access, const void *values, sh_load *load)
{
    sh_instance *instance = sh_begin_set(access, values);
    size_t i, k, next = 0;

    if (instance == NULL) {
        return SH_ERROR;
    }
    if (load == NULL) {
        return SH_OK;
    }
    for (i = 0; i < access->count; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[access->references[i]];
        for (k = 0; k < length_of(access, first) && next < access->length; ++k, ++next) {
            if (sh_is_parameter(first) &&
                !sh_accepts(instance, first + k, load(values, next), access->function)) {
                return SH_ERROR;
            }
        }
    }
    for (next = 0, i = 0; i < access->count; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[access->references[i]];
        for (k = 0; k < length_of(access, first) && next < access->length; ++k) {
            sh_write(instance, first + k, load(values, next++));
        }
    }
    return SH_OK;
}
