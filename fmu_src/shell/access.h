/* Calls of the importer that read and write variables by their references. */
#ifndef SH_ACCESS_H
#define SH_ACCESS_H

#include <stdint.h>

#include "simulation.h"

/* Type of the values in the importer's array. */
typedef enum {
    SH_DOUBLES,
    SH_INTS,
    SH_INT64S,
    SH_BYTES /* Booleans: other values than true and false must not be read as a bool */
} sh_values;

/* One call of the importer that reads or writes variables. */
typedef struct {
    void *handle;         /* handle from the importer; may be NULL */
    const char *function; /* name of the called function, for messages */
    unsigned types;       /* allowed SH_TYPE_*; 0: any reference is an error */
    sh_values values;
    int fmi3; /* 1: time is a variable, and start values can be read before the initialisation */
    const uint32_t *references;
    size_t count;  /* number of references */
    size_t length; /* length of the importer's array of values */
} sh_access;

/* Reads the variables of a call. Initial outputs are computed from the values set so far. */
sh_status sh_get(const sh_access *access, void *values);

/* Writes the variables of a call, all or none. */
sh_status sh_set(const sh_access *access, const void *values);

/* The instance of a call whose variables can all be set now, to these values; else NULL, after a
 * message.
 */
sh_instance *sh_begin_set(const sh_access *access, const void *values);

/* Name of a type in this version of FMI, for messages. */
const char *sh_type_name(sh_type type);

#endif
