#include "log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The first ones are those of an sh_status. */
static const struct {
    const char *name;
    unsigned category;
} KNOWN[] = {{"logEvents", SH_LOG_EVENTS},
             {"logStatusWarning", SH_LOG_WARNING},
             {"logStatusDiscard", SH_LOG_DISCARD},
             {"logStatusError", SH_LOG_ERROR},
             {"logAll", SH_LOG_ALL}};

/* Bytes of the UTF-8 character that begins here, or 0 if none does (RFC 3629). */
static size_t utf8_length(const unsigned char *s)
{
    unsigned char low = 0x80, high = 0xbf; /* of the second byte */
    size_t length, i;

    if (s[0] < 0x80) {
        return 1;
    }
    if (s[0] < 0xc2 || s[0] > 0xf4) {
        return 0;
    }
    length = s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : 4;
    if (s[0] == 0xe0) {
        low = 0xa0; /* other characters have a shorter form */
    } else if (s[0] == 0xed) {
        high = 0x9f; /* no halves of surrogate pairs */
    } else if (s[0] == 0xf0) {
        low = 0x90;
    } else if (s[0] == 0xf4) {
        high = 0x8f; /* no characters above U+10FFFF */
    }
    if (s[1] < low || s[1] > high) {
        return 0;
    }
    for (i = 2; i < length; ++i) {
        if ((s[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    return length;
}

int sh_make_utf8(char *text)
{
    int replaced = 0;

    while (*text != '\0') {
        size_t length = utf8_length((const unsigned char *)text);
        if (length == 0) {
            *text = '?';
            replaced = 1;
            length = 1;
        }
        text += length;
    }
    return replaced;
}

void sh_report(sh_instance *instance, sh_status status, const char *format, ...)
{
    char text[512];
    va_list arguments;

    if (instance->importer.logger == NULL || !(instance->categories & KNOWN[status].category)) {
        return;
    }
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)sh_make_utf8(text); /* may contain text of the importer, or be cut inside a character */
    sh_deliver(instance, status, KNOWN[status].name, text);
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

void sh_double(char *copy, size_t size, const char *text, char special)
{
    size_t length = 0;

    for (; *text != '\0' && length + 2 < size; ++text) {
        if (*text == special) {
            copy[length++] = special;
        }
        copy[length++] = *text;
    }
    copy[length] = '\0';
}
