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
        const sh_access access = {instance,        "fmi3Get" #Type,  TYPES,  1,                    \
                                  valueReferences, nValueReferences, nValues};                     \
        return (fmi3Status)sh_get(&access, (void *)values, store);                                 \
    }                                                                                              \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const fmi3##Type values[], size_t nValues)   \
    {                                                                                              \
        const sh_access access = {instance,        "fmi3Set" #Type,  TYPES,  1,                    \
                                  valueReferences, nValueReferences, nValues};                     \
        return (fmi3Status)sh_set(&access, (const void *)values, load);                            \
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
    const sh_access access = {instance,        "fmi3GetBinary",  0,      1,
                              valueReferences, nValueReferences, nValues};

    (void)valueSizes;
    return (fmi3Status)sh_get(&access, (void *)values, NULL);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues)
{
    const sh_access access = {instance,        "fmi3SetBinary",  0,      1,
                              valueReferences, nValueReferences, nValues};

    (void)valueSizes;
    return (fmi3Status)sh_set(&access, (const void *)values, NULL);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, fmi3Clock values[])
{
    const sh_access access = {instance,         "fmi3GetClock",  0, 1, valueReferences,
                              nValueReferences, nValueReferences};

    return (fmi3Status)sh_get(&access, (void *)values, NULL);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, const fmi3Clock values[])
{
    const sh_access access = {instance,         "fmi3SetClock",  0, 1, valueReferences,
                              nValueReferences, nValueReferences};

    return (fmi3Status)sh_set(&access, (const void *)values, NULL);
}
