/* Messages for the user: the importer chooses categories, and sh_report (model.h) sends a message of one of them. */
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

/* Converts names of categories to a bit set *found of SH_LOG_*, which is SH_LOG_ALL if count is 0. Returns SH_WARNING,
 * after a message, if a category is unknown and therefore ignored.
 */
sh_status sh_find_categories(sh_instance *instance, size_t count, const char *const categories[],
                             unsigned *found, const char *function);

#endif
