/* Functions of FMI 3.0 that read and write variables. All variables are scalars. */
#include "access.h"
#include "fmi3Functions.h"

#define CALL(function, types, type_of_values)                                                      \
    const sh_access access = {instance,        function,         types,  type_of_values, 1,        \
                              valueReferences, nValueReferences, nValues}

#define ACCESS(Type, TYPES, VALUES)                                                                \
    fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, fmi3##Type values[], size_t nValues)         \
    {                                                                                              \
        CALL("fmi3Get" #Type, TYPES, VALUES);                                                      \
        return (fmi3Status)sh_get(&access, (void *)values);                                        \
    }                                                                                              \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const fmi3##Type values[], size_t nValues)   \
    {                                                                                              \
        CALL("fmi3Set" #Type, TYPES, VALUES);                                                      \
        return (fmi3Status)sh_set(&access, (const void *)values);                                  \
    }

ACCESS(Float64, SH_TYPE_REAL, SH_DOUBLES)
ACCESS(Int32, SH_TYPE_INTEGER, SH_INTS)
ACCESS(Int64, SH_TYPE_ENUMERATION, SH_INT64S)
ACCESS(Boolean, SH_TYPE_BOOLEAN, SH_BYTES)

/* No variable has the type Float32, an integer type other than Int32 and Int64, or String. */
ACCESS(Float32, 0, SH_BYTES)
ACCESS(Int8, 0, SH_BYTES)
ACCESS(UInt8, 0, SH_BYTES)
ACCESS(Int16, 0, SH_BYTES)
ACCESS(UInt16, 0, SH_BYTES)
ACCESS(UInt32, 0, SH_BYTES)
ACCESS(UInt64, 0, SH_BYTES)
ACCESS(String, 0, SH_BYTES)

/* Nor has any variable the type Binary, whose values have sizes of their own. */
fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, size_t valueSizes[], fmi3Binary values[],
                         size_t nValues)
{
    CALL("fmi3GetBinary", 0, SH_BYTES);
    (void)valueSizes;
    return (fmi3Status)sh_get(&access, (void *)values);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                         size_t nValueReferences, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues)
{
    CALL("fmi3SetBinary", 0, SH_BYTES);
    (void)valueSizes;
    return (fmi3Status)sh_set(&access, (const void *)values);
}
