/* FMI 3.0: reading and writing variables, which are scalars. */
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

#define CALL(function, types, type_of_values, length)                                              \
    const sh_access access = {instance,        function,         types, type_of_values, 1,         \
                              valueReferences, nValueReferences, length}

#define ACCESS(Type, TYPES, VALUES)                                                                \
    fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, fmi3##Type values[], size_t nValues)         \
    {                                                                                              \
        CALL("fmi3Get" #Type, TYPES, VALUES, nValues);                                             \
        return (fmi3Status)sh_get(&access, (void *)values);                                        \
    }                                                                                              \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const fmi3##Type values[], size_t nValues)   \
    {                                                                                              \
        CALL("fmi3Set" #Type, TYPES, VALUES, nValues);                                             \
        return (fmi3Status)sh_set(&access, (const void *)values);                                  \
    }

ACCESS(Float64, SH_TYPE_REAL, SH_DOUBLES)
ACCESS(Int32, SH_TYPE_INTEGER, SH_INTS)
ACCESS(Int64, SH_TYPE_ENUMERATION, SH_INT64S)
ACCESS(Boolean, SH_TYPE_BOOLEAN, SH_BYTES)

/* No variable has one of these types: every reference is refused. */
ACCESS(Float32, 0, SH_BYTES)
ACCESS(Int8, 0, SH_BYTES)
ACCESS(UInt8, 0, SH_BYTES)
ACCESS(Int16, 0, SH_BYTES)
ACCESS(UInt16, 0, SH_BYTES)
ACCESS(UInt32, 0, SH_BYTES)
ACCESS(UInt64, 0, SH_BYTES)
ACCESS(String, 0, SH_BYTES)

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, size_t valueSizes[], fmi3Binary values[],
                         size_t nValues)
{
    CALL("fmi3GetBinary", 0, SH_BYTES, nValues);

    (void)valueSizes;
    return (fmi3Status)sh_get(&access, (void *)values);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues)
{
    CALL("fmi3SetBinary", 0, SH_BYTES, nValues);

    (void)valueSizes;
    return (fmi3Status)sh_set(&access, (const void *)values);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, fmi3Clock values[])
{
    CALL("fmi3GetClock", 0, SH_BYTES, nValueReferences);

    return (fmi3Status)sh_get(&access, (void *)values);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                        size_t nValueReferences, const fmi3Clock values[])
{
    CALL("fmi3SetClock", 0, SH_BYTES, nValueReferences);

    return (fmi3Status)sh_set(&access, (const void *)values);
}
