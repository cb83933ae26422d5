#include "access.h"

#include <stdbool.h>

#include "guards.h"
#include "simulation.h"
#include "version.h"

/* Returns 1 for the value reference of time, a variable of FMI 3.0. Time follows the references of the table. */
static int is_time(const sh_access *access, uint32_t reference)
{
    return access->fmi3 && reference == sh_fmu_model.count;
}

static void refuse_reference(const sh_access *access, uint32_t reference)
{
    if (is_time(access, reference)) {
        sh_report(access->handle, SH_ERROR,
                  "%s: value reference %lu is time, which can only be read, as Float64.",
                  access->function, (unsigned long)reference);
    } else if (reference >= sh_fmu_model.count) {
        sh_report(access->handle, SH_ERROR, "%s: unknown value reference %lu; the last one is %lu.",
                  access->function, (unsigned long)reference,
                  (unsigned long)sh_fmu_model.count - 1);
    } else {
        const sh_variable *variable = &sh_fmu_model.variables[reference];
        sh_report(access->handle, SH_ERROR, "%s: value reference %lu is %s, which is %s.",
                  access->function, (unsigned long)reference, variable->name,
                  sh_type_name(variable->type));
    }
}

/* Returns the variable of a value reference, or NULL if the called function does not handle its type. */
static const sh_variable *find(const sh_access *access, uint32_t reference)
{
    if (reference < sh_fmu_model.count) {
        const sh_variable *variable = &sh_fmu_model.variables[reference];
        if ((unsigned)variable->type & access->types) {
            return variable;
        }
    }
    return NULL;
}

/* Returns 1 if a parameter or an output may be set now, else 0 after a message. sh_begin_set handles inputs. */
static int may_be_set(sh_instance *instance, const sh_variable *variable, const char *function)
{
    static const struct {
        unsigned states;
        const char *rule;
    } RULES[SH_ROLE_TUNABLE + 1] = {
        [SH_ROLE_OUTPUT] = {0, "an output"},
        [SH_ROLE_GUESS] = {SH_INSTANTIATED, "an output"}, /* the start value, later overwritten */
        [SH_ROLE_FIXED] = {SH_INSTANTIATED | SH_INITIALIZATION,
                           "a fixed parameter, settable until the end of initialisation"},
        [SH_ROLE_TUNABLE] = {SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, "a tunable parameter"},
    };

    if ((unsigned)instance->state & RULES[variable->role].states) {
        return 1;
    }
    sh_report(instance, SH_ERROR, "%s: %s cannot be set now: it is %s.", function, variable->name,
              RULES[variable->role].rule);
    return 0;
}

/* Returns element i of the importer's array as a double, which can represent the value of any variable. */
static double load(const sh_access *access, const void *values, size_t i)
{
    if (access->values == SH_DOUBLES) {
        return ((const double *)values)[i];
    }
    return access->values == SH_INTS     ? (double)((const int *)values)[i]
           : access->values == SH_INT64S ? (double)((const int64_t *)values)[i]
                                         : (double)((const unsigned char *)values)[i];
}

static void store(const sh_access *access, void *values, size_t i, double value)
{
    if (access->values == SH_DOUBLES) {
        ((double *)values)[i] = value;
    } else if (access->values == SH_INTS) {
        ((int *)values)[i] = (int)value;
    } else if (access->values == SH_INT64S) {
        ((int64_t *)values)[i] = (int64_t)value;
    } else {
        ((bool *)values)[i] = value != 0.0;
    }
}

/* Returns the instance of a call whose arguments are valid, else NULL after a message. */
static sh_instance *begin(const sh_access *access, unsigned states, const void *values)
{
    sh_instance *instance = sh_enter(access->handle, states, access->function);

    if (instance == NULL ||
        (access->count > 0 &&
         (!sh_has(instance, access->references, access->function, "valueReferences") ||
          !sh_has(instance, values, access->function, "values")))) {
        return NULL;
    }
    if (access->length != access->count) {
        sh_report(instance, SH_ERROR, "%s: nValues = %lu; expected %lu, one for each reference.",
                  access->function, (unsigned long)access->length, (unsigned long)access->count);
        return NULL;
    }
    return instance;
}

sh_instance *sh_begin_set(const sh_access *access, const void *values)
{
    sh_instance *instance = begin(access, SH_INSTANTIATED | SH_INITIALIZATION | SH_STEP, values);
    size_t i;

    if (instance == NULL) {
        return NULL;
    }
    for (i = 0; i < access->count; ++i) {
        const sh_variable *variable = find(access, access->references[i]);
        if (variable == NULL) {
            refuse_reference(access, access->references[i]);
            return NULL;
        }
        if (variable->role == SH_ROLE_INPUT) { /* an input may have any value, see sh_accepts */
            continue;
        }
        if (!may_be_set(instance, variable, access->function)) {
            return NULL;
        }
        if (sh_is_parameter(variable)) {
            if (!sh_accepts(instance, variable, load(access, values, i), access->function)) {
                return NULL;
            }
            instance->parameters_unchecked = 1;
        }
    }
    if (instance->state == SH_INITIALIZATION) {
        instance->outputs_stale = 1;
    }
    return instance;
}

sh_status sh_get(const sh_access *access, void *values)
{
    const unsigned states =
        SH_INITIALIZATION | SH_STEP | SH_TERMINATED | (access->fmi3 ? SH_INSTANTIATED : 0);
    sh_instance *instance = begin(access, states, values);
    size_t i;

    if (instance == NULL) {
        return SH_ERROR;
    }
    for (i = 0; i < access->count; ++i) {
        const uint32_t reference = access->references[i];
        if (find(access, reference) == NULL &&
            !(access->types == SH_TYPE_REAL && is_time(access, reference))) {
            refuse_reference(access, reference);
            return SH_ERROR;
        }
    }
    if (instance->state == SH_INITIALIZATION && sh_initialize(instance) != SH_OK) {
        return SH_ERROR;
    }
    for (i = 0; i < access->count; ++i) {
        const uint32_t reference = access->references[i];
        store(access, values, i,
              reference < sh_fmu_model.count ? sh_read(instance, &sh_fmu_model.variables[reference])
                                             : instance->time);
    }
    return SH_OK;
}

/* Tells the model which parameters were set. */
static void let_start_values_follow(sh_instance *instance, const sh_access *access)
{
    size_t i;

    for (i = 0; i < access->count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[access->references[i]];
        if (sh_is_parameter(variable)) {
            sh_fmu_model.follow(instance->model, variable->offset);
        }
    }
}

sh_status sh_set(const sh_access *access, const void *values)
{
    sh_instance *instance = sh_begin_set(access, values);
    size_t i;

    if (instance == NULL) {
        return SH_ERROR;
    }
    for (i = 0; i < access->count; ++i) {
        sh_write(instance, &sh_fmu_model.variables[access->references[i]], load(access, values, i));
    }
    if (instance->parameters_unchecked && sh_fmu_model.follow != NULL) {
        let_start_values_follow(instance, access);
    }
    return SH_OK;
}
