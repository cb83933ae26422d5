/* Functions that read and write variables of the FMU by their value references. */
#ifndef SH_ACCESS_H
#define SH_ACCESS_H

#include <stdint.h>

#include "instance.h"

/* Type of the elements in the importer's array of values. */
typedef enum {
    SH_DOUBLES,
    SH_INTS,
    SH_INT64S,
    SH_BYTES /* Boolean values as bytes, because C must not read a byte above 1 as a bool */
} sh_values;

/* One call of the importer that reads or writes variables. */
typedef struct {
    void *handle;         /* instance as passed by the importer; may be NULL */
    const char *function; /* name of the called function, for messages */
    unsigned types;       /* bit set of the allowed SH_TYPE_*; 0: any reference is an error */
    sh_values values;
    int fmi3; /* 1 in FMI 3.0: time is a variable, start values are readable before initialisation */
    const uint32_t *references;
    size_t count;  /* number of value references */
    size_t length; /* number of elements in the importer's array of values */
} sh_access;

/* Reads the variables of a call. During initialisation, outputs are computed from the values that were set so far. */
sh_status sh_get(const sh_access *access, void *values);

/* Writes all variables of a call, or none of them after an error. */
sh_status sh_set(const sh_access *access, const void *values);

/* Returns the instance if all variables of a call can be set to `values` now, else NULL after a message. */
sh_instance *sh_begin_set(const sh_access *access, const void *values);

#endif
