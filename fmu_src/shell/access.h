/* Calls of the importer that read and write variables by their references. */
#ifndef SH_ACCESS_H
#define SH_ACCESS_H

#include <stdint.h>

#include "instance.h"

/* One call of the importer that reads or writes variables. */
typedef struct {
    void *handle;         /* the importer's; it may be NULL */
    const char *function; /* its name for messages */
    unsigned types;       /* SH_TYPE_* that it is for */
    int arrays;           /* 1, FMI 3.0: a reference means a whole array; 0: one element */
    const uint32_t *references;
    size_t count;  /* of references */
    size_t length; /* of the importer's array of values */
} sh_access;

/* Conversion of one value between the importer's array and a double, which holds all of ours. */
typedef void sh_store(void *values, size_t i, double value);
typedef double sh_load(const void *values, size_t i);

/* Reads the variables of a call. Initial outputs follow what was set so far. `store` may be NULL if
 * the call is for no type: then any reference is an error.
 */
sh_status sh_get(const sh_access *access, void *values, sh_store *store);

/* Writes the variables of a call, all or none; `load` as `store`. */
sh_status sh_set(const sh_access *access, const void *values, sh_load *load);

/* The instance of a call whose variables can all be set now; else NULL, after a message. */
sh_instance *sh_begin_set(const sh_access *access, const void *values);

/* Name of a type in this version of FMI, for messages. */
const char *sh_type_name(sh_type type);

#endif
