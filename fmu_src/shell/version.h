/* What a version of FMI gives to the shell, which is the same for all versions: fmi2/version.c and fmi3/version.c. */
#ifndef SH_VERSION_H
#define SH_VERSION_H

#include "instance.h"

/* A character with a special meaning in messages of this version. A message contains it twice. */
extern const char sh_special;

/* Passes a message to the logger of the importer, which must not be NULL. */
void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text);

/* Returns the name of a type of variables, for messages. */
const char *sh_type_name(sh_type type);

#endif
