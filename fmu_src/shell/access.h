/* Reading and writing variables by their references. */
#ifndef SH_ACCESS_H
#define SH_ACCESS_H

#include <stdint.h>

#include "instance.h"

/* One call of the importer that reads or writes variables. */
typedef struct {
    void *handle;         /* the importer's; it may be NULL */
    const char *function; /* its name for messages */
    unsigned types;       /* SH_TYPE_* that it is for */
    int arrays;           /* 1: a reference means a whole array, 0: one element */
} sh_access;

/* The instance of a call that may read or write now; else NULL, after a message. Reading computes
 * initial outputs that what was set so far gives. Writing refuses any reference to what cannot be
 * set now: a call sets all of its variables or none.
 */
sh_instance *sh_begin_get(const sh_access *access, const uint32_t references[], size_t count,
                          const void *values);
sh_instance *sh_begin_set(const sh_access *access, const uint32_t references[], size_t count,
                          const void *values);

/* The variable of a reference, or the first one of its array; NULL after a message. */
const sh_variable *sh_find(const sh_access *access, uint32_t reference);

/* Name of a type in this version of FMI, for messages. */
const char *sh_type_name(sh_type type);

/* 1 if the variable may have this value; else 0, after a message. Only parameters have limits: an
 * input that is not finite skips ticks.
 */
int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function);

/* The value of a variable of any type: a double holds every int. */
double sh_read(const sh_instance *instance, const sh_variable *variable);
void sh_write(sh_instance *instance, const sh_variable *variable, double value);

/* Time derivative of a Real input. */
double *sh_slope(sh_instance *instance, const sh_variable *input);

#endif
