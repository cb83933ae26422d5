/* An importer that may do anything which FMI allows, for the proof of the shell by Frama-C Eva.
 *
 * Eva computes with sets of values: a call of a function here returns all values that it can return.
 */
#ifndef SHELL_IMPORTER_H
#define SHELL_IMPORTER_H

#include <stddef.h>
#include <stdint.h>

#include "instance.h"

int any_choice(void); /* 0 or 1 */
int any_int(void);
size_t any_size(void);
double any_real(void);      /* infinities and NaN, too */
const char *any_text(void); /* at most 15 bytes of any value, then 0 */

/* Memory of exactly this size with any bytes. */
void *any_bytes(size_t size);

/* Allocation by the importer: NULL, or memory with any bytes. */
void *allocate(size_t count, size_t size);
void release(void *memory);

#endif
