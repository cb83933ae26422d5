/* Memory of the importer, for instances and saved states. */
#ifndef SH_ALLOCATION_H
#define SH_ALLOCATION_H

#include "instance.h"

/* Allocates memory filled with zeros, by the functions of the importer if there are any, else by the C library.
 * Returns NULL if there is no memory.
 */
void *sh_allocate(const sh_importer *importer, size_t size);

/* Frees memory of sh_allocate, which may be NULL. */
void sh_release(const sh_importer *importer, void *memory);

#endif
