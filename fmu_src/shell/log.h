/* Categories of the messages for the user, and the delivery of messages to the importer. */
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

/* The character sh_special has a special meaning in messages of a version of FMI, so sh_report writes it twice. The
 * function sh_deliver passes a message to the logger of the importer. This logger must not be NULL.
 */
extern const char sh_special;
void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text);

/* Converts names of categories to a bit set *found of SH_LOG_*, which is SH_LOG_ALL if count is 0. Unknown categories
 * are ignored with a warning. The importer passes `handle`, which may be NULL.
 */
sh_status sh_find_categories(void *handle, size_t count, const char *const categories[],
                             unsigned *found, const char *function);

#endif
