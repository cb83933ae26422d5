/* Messages for the user: their categories, and text that an importer can rely on. */
#ifndef SH_LOG_H
#define SH_LOG_H

#include "instance.h"

/* Categories of messages, as bits. */
enum {
    SH_LOG_EVENTS = 1,
    SH_LOG_WARNING = 2,
    SH_LOG_DISCARD = 4,
    SH_LOG_ERROR = 8,
    SH_LOG_STATUS = 14, /* all but events */
    SH_LOG_ALL = 15
};

/* Each version of FMI has its own escape character in messages, which sh_report writes twice. Each version also has
 * its own function that gives a message to the importer's logger, which is not NULL.
 */
extern const char sh_special;
void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text);

/* Writes the SH_LOG_* of some categories to *found, SH_LOG_ALL if count is 0. Unknown categories
 * are ignored, with a warning. `handle` is from the importer, and may be NULL.
 */
sh_status sh_find_categories(void *handle, size_t count, const char *const categories[],
                             unsigned *found, const char *function);

#endif
