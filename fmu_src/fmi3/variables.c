/* FMI 3.0: reading and writing variables, arrays as a whole. */
#include <stdbool.h>

#include "access.h"
#include "fmi3Functions.h"

const char *sh_type_name(sh_type type)
{
    switch (type) {
    case SH_TYPE_REAL:
        return "Float64";
    case SH_TYPE_INTEGER:
        return "Int32";
    case SH_TYPE_ENUMERATION:
        return "an Enumeration (Int64)";
    default:
        return "Boolean";
    }
}

/* Time, the independent variable: it has the reference after those of the table. */
static int is_time(const sh_access *access, fmi3ValueReference reference)
{
    return access->types == SH_TYPE_REAL && reference == sh_fmu_model.count;
}

/* Whether the arrays behind the references have `expected` elements in all. */
static int fits(const sh_access *access, const fmi3ValueReference references[], size_t count,
                size_t expected)
{
    size_t found = 0, i;

    for (i = 0; i < count; ++i) {
        const sh_variable *variable;

        if (is_time(access, references[i])) {
            found += 1;
            continue;
        }
        variable = sh_find(access, references[i]);
        if (variable == NULL)
            return 0;
        found += variable->length;
    }
    if (found == expected)
        return 1;
    sh_log(access->handle, SH_ERROR,
           "%s: nValues = %lu; expected %lu, the number of elements behind %lu references.",
           access->function, (unsigned long)expected, (unsigned long)found, (unsigned long)count);
    return 0;
}

/* Conversion of one value between the importer's array and a double, which holds all of ours. */
typedef void store_value(void *values, size_t i, double value);
typedef double load_value(const void *values, size_t i);

static fmi3Status get(const sh_access *access, const fmi3ValueReference references[], size_t count,
                      void *values, size_t nValues, store_value *store)
{
    const sh_instance *instance = sh_begin_get(access, references, count, values);
    size_t i, k, next = 0;

    if (instance == NULL || !fits(access, references, count, nValues))
        return fmi3Error;
    if (store == NULL) /* no variable has the type, so there was no reference */
        return fmi3OK;
    for (i = 0; i < count; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[references[i]];
        if (is_time(access, references[i]))
            store(values, next++, instance->time);
        else
            for (k = 0; k < first->length; ++k)
                store(values, next++, sh_read(instance, first + k));
    }
    return fmi3OK;
}

static fmi3Status set(const sh_access *access, const fmi3ValueReference references[], size_t count,
                      const void *values, size_t nValues, load_value *load)
{
    sh_instance *instance = sh_begin_set(access, references, count, values);
    size_t i, k, next = 0;

    if (instance == NULL || !fits(access, references, count, nValues))
        return fmi3Error;
    if (load == NULL)
        return fmi3OK;
    for (i = 0; i < count; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[references[i]];
        for (k = 0; k < first->length; ++k)
            if (!sh_accepts(instance, first + k, load(values, next++), access->function))
                return fmi3Error;
    }
    for (next = 0, i = 0; i < count; ++i) {
        const sh_variable *first = &sh_fmu_model.variables[references[i]];
        for (k = 0; k < first->length; ++k)
            sh_write(instance, first + k, load(values, next++));
    }
    return fmi3OK;
}

#define CONVERSIONS(Type)                                                                          \
    static void store##Type(void *values, size_t i, double value)                                  \
    {                                                                                              \
        ((fmi3##Type *)values)[i] = (fmi3##Type)value;                                             \
    }                                                                                              \
    static double load##Type(const void *values, size_t i)                                         \
    {                                                                                              \
        return (double)((const fmi3##Type *)values)[i];                                            \
    }

CONVERSIONS(Float64)
CONVERSIONS(Int32)
CONVERSIONS(Int64)

static void storeBoolean(void *values, size_t i, double value)
{
    ((fmi3Boolean *)values)[i] = value != 0.0;
}

/* As a byte, because a bool that is neither true nor false must not be read as one. */
static double loadBoolean(const void *values, size_t i)
{
    return (double)((const unsigned char *)values)[i];
}

#define ACCESS(Type, TYPES, store, load)                                                           \
    fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, fmi3##Type values[], size_t nValues)         \
    {                                                                                              \
        const sh_access access = {instance, "fmi3Get" #Type, TYPES, 1};                            \
        return get(&access, valueReferences, nValueReferences, (void *)values, nValues, store);    \
    }                                                                                              \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const fmi3##Type values[], size_t nValues)   \
    {                                                                                              \
        const sh_access access = {instance, "fmi3Set" #Type, TYPES, 1};                            \
        return set(&access, valueReferences, nValueReferences, (const void *)values, nValues,      \
                   load);                                                                          \
    }

ACCESS(Float64, SH_TYPE_REAL, storeFloat64, loadFloat64)
ACCESS(Int32, SH_TYPE_INTEGER, storeInt32, loadInt32)
ACCESS(Int64, SH_TYPE_ENUMERATION, storeInt64, loadInt64)
ACCESS(Boolean, SH_TYPE_BOOLEAN, storeBoolean, loadBoolean)

/* No variable has one of these types: every reference is refused. */
ACCESS(Float32, 0, NULL, NULL)
ACCESS(Int8, 0, NULL, NULL)
ACCESS(UInt8, 0, NULL, NULL)
ACCESS(Int16, 0, NULL, NULL)
ACCESS(UInt16, 0, NULL, NULL)
ACCESS(UInt32, 0, NULL, NULL)
ACCESS(UInt64, 0, NULL, NULL)
ACCESS(String, 0, NULL, NULL)

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, size_t valueSizes[], fmi3Binary values[],
                         size_t nValues)
{
    const sh_access access = {instance, "fmi3GetBinary", 0, 1};

    (void)valueSizes;
    return get(&access, valueReferences, nValueReferences, (void *)values, nValues, NULL);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues)
{
    const sh_access access = {instance, "fmi3SetBinary", 0, 1};

    (void)valueSizes;
    return set(&access, valueReferences, nValueReferences, (const void *)values, nValues, NULL);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, fmi3Clock values[])
{
    const sh_access access = {instance, "fmi3GetClock", 0, 1};

    return get(&access, valueReferences, nValueReferences, values, nValueReferences, NULL);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, const fmi3Clock values[])
{
    const sh_access access = {instance, "fmi3SetClock", 0, 1};

    return set(&access, valueReferences, nValueReferences, values, nValueReferences, NULL);
}
