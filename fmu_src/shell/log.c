#include "log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "version.h"

/* All categories of messages. The first four categories belong to the values of sh_status, in the same order. */
static const struct {
    const char *name;
    unsigned category;
} KNOWN[] = {{"logEvents", SH_LOG_EVENTS},
             {"logStatusWarning", SH_LOG_WARNING},
             {"logStatusDiscard", SH_LOG_DISCARD},
             {"logStatusError", SH_LOG_ERROR},
             {"logAll", SH_LOG_ALL}};

/* Copies at most size - 1 characters of a message, and replaces each byte that is not ASCII by '?'. Text from the
 * importer may be invalid UTF-8, or may be cut inside of a character.
 */
static void escape(char *copy, size_t size, const char *text)
{
    size_t length = 0;

    for (; *text != '\0' && length + 2 < size; ++text) {
        if (*text == sh_special) {
            copy[length++] = sh_special;
        }
        copy[length++] = (unsigned char)*text < 0x80 ? *text : '?';
    }
    copy[length] = '\0';
}

static void send(const sh_instance *instance, sh_status status, const char *format,
                 va_list arguments)
{
    char text[512], escaped[1024];

    if (instance->importer.logger == NULL || !(instance->categories & KNOWN[status].category)) {
        return;
    }
    (void)vsnprintf(text, sizeof text, format, arguments);
    escape(escaped, sizeof escaped, text);
    sh_deliver(instance, status, KNOWN[status].name, escaped);
}

void sh_report(sh_instance *instance, sh_status status, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    send(instance, status, format, arguments);
    va_end(arguments);
}

void sh_warn_once(sh_instance *instance, const char *format, ...)
{
    va_list arguments;

    if (instance->warned) {
        return;
    }
    instance->warned = 1;
    va_start(arguments, format);
    send(instance, SH_WARNING, format, arguments);
    va_end(arguments);
}

sh_status sh_find_categories(sh_instance *instance, size_t count, const char *const categories[],
                             unsigned *found, const char *function)
{
    sh_status status = SH_OK;
    size_t i, k;

    *found = count > 0 ? 0 : SH_LOG_ALL;
    for (i = 0; i < count; ++i) {
        unsigned category = 0;
        for (k = 0; k < sizeof KNOWN / sizeof KNOWN[0]; ++k) {
            if (categories[i] != NULL && strcmp(categories[i], KNOWN[k].name) == 0) {
                category = KNOWN[k].category;
            }
        }
        if (category == 0) {
            sh_report(instance, SH_WARNING,
                      "%s: unknown category %s is ignored; known are logEvents, logStatusWarning, "
                      "logStatusDiscard, logStatusError and logAll.",
                      function, categories[i] != NULL ? categories[i] : "NULL");
            status = SH_WARNING;
        }
        *found |= category;
    }
    return status;
}
