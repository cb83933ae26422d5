/* How an instance begins and ends: the functions that create, reset and free it. */
#ifndef SH_CREATION_H
#define SH_CREATION_H

#include "instance.h"

/* Creates an instance that logs the given categories of messages. Returns NULL after an error message. */
sh_instance *sh_create(const sh_importer *importer, const char *name, const char *guid,
                       unsigned categories, const char *function);

/* Returns NULL, after a message that the FMU does not support the wanted kind of simulation. */
void *sh_refuse_instance(const sh_importer *importer, const char *function, const char *wanted);

/* Resets an instance to its state after sh_create with all start values. The logged categories remain the same. */
sh_status sh_reset(void *handle, const char *function);

/* Frees an instance, which may be NULL. */
void sh_destroy(sh_instance *instance);

#endif
