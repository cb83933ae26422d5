#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned category_of(fmi2Status status)
{
    switch (status) {
    case fmi2OK:
        return SH_LOG_EVENTS;
    case fmi2Warning:
        return SH_LOG_WARNING;
    case fmi2Discard:
        return SH_LOG_DISCARD;
    default:
        return SH_LOG_ERROR;
    }
}

static const char *category_name(unsigned category)
{
    switch (category) {
    case SH_LOG_EVENTS:
        return "logEvents";
    case SH_LOG_WARNING:
        return "logStatusWarning";
    case SH_LOG_DISCARD:
        return "logStatusDiscard";
    default:
        return "logStatusError";
    }
}

/* Bytes of the UTF-8 character that begins here, or 0 if none does (RFC 3629). */
static size_t utf8_length(const unsigned char *s)
{
    unsigned char low = 0x80, high = 0xbf; /* of the second byte */
    size_t length, i;

    if (s[0] < 0x80)
        return 1;
    if (s[0] < 0xc2 || s[0] > 0xf4)
        return 0;
    length = s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : 4;
    if (s[0] == 0xe0)
        low = 0xa0; /* the rest has a shorter form */
    else if (s[0] == 0xed)
        high = 0x9f; /* no halves of surrogate pairs */
    else if (s[0] == 0xf0)
        low = 0x90;
    else if (s[0] == 0xf4)
        high = 0x8f; /* no characters above U+10FFFF */
    if (s[1] < low || s[1] > high)
        return 0;
    for (i = 2; i < length; ++i)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
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

void sh_log(sh_instance *instance, fmi2Status status, const char *format, ...)
{
    const unsigned category = category_of(status);
    char text[512], escaped[2 * sizeof text];
    size_t length = 0, i;
    va_list arguments;

    if (instance->callbacks.logger == NULL || !(instance->categories & category))
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sh_make_utf8(text); /* it may contain text of the importer, or be cut inside a character */
    /* The logger uses the message as a format: a % must not start a conversion. */
    for (i = 0; text[i] != '\0'; ++i) {
        if (text[i] == '%')
            escaped[length++] = '%';
        escaped[length++] = text[i];
    }
    escaped[length] = '\0';
    instance->callbacks.logger(instance->callbacks.componentEnvironment, instance->name, status,
                               category_name(category), escaped);
}

static const char *state_name(sh_state state)
{
    switch (state) {
    case SH_INSTANTIATED:
        return "before initialisation";
    case SH_INITIALIZATION:
        return "in initialisation mode";
    case SH_STEP:
        return "between steps";
    default:
        return "after termination";
    }
}

sh_instance *sh_enter(fmi2Component c, unsigned allowed_states, const char *function)
{
    sh_instance *instance = c;

    if (instance == NULL)
        return NULL; /* no logger to report it to */
    if (!((unsigned)instance->state & allowed_states)) {
        sh_log(instance, fmi2Error, "%s: not allowed %s.", function, state_name(instance->state));
        return NULL;
    }
    return instance;
}

int sh_has(sh_instance *instance, const void *pointer, const char *function, const char *argument)
{
    if (pointer != NULL)
        return 1;
    sh_log(instance, fmi2Error, "%s: argument %s is NULL.", function, argument);
    return 0;
}

/* Both or none: memory must be freed by the same library that allocated it. */
static int importer_allocates(const fmi2CallbackFunctions *callbacks)
{
    return callbacks->allocateMemory != NULL && callbacks->freeMemory != NULL;
}

void *sh_allocate(const fmi2CallbackFunctions *callbacks, size_t size)
{
    void *memory =
        importer_allocates(callbacks) ? callbacks->allocateMemory(1, size) : malloc(size);

    if (memory != NULL)
        memset(memory, 0, size);
    return memory;
}

void sh_release(const fmi2CallbackFunctions *callbacks, void *memory)
{
    if (memory == NULL)
        return;
    if (importer_allocates(callbacks))
        callbacks->freeMemory(memory);
    else
        free(memory);
}

void sh_set_start_values(sh_instance *instance)
{
    char *bytes = instance->model;
    size_t i;

    memset(bytes, 0, sh_fmu_model.size);
    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        void *place = bytes + variable->offset;
        if (variable->type == SH_TYPE_REAL)
            *(double *)place = variable->start;
        else
            *(int *)place = (int)variable->start;
    }
    instance->outputs_stale = 1;
    instance->parameters_unchecked = 1;
}

/* Writes the allowed range of a variable, "[0, 1]" or "(-inf, inf)". */
static void write_range(char *text, size_t size, const sh_variable *variable)
{
    snprintf(text, size, "%c%.9g, %.9g%c", isfinite(variable->min) ? '[' : '(', variable->min,
             variable->max, isfinite(variable->max) ? ']' : ')');
}

static int in_range(const sh_variable *variable, double value)
{
    return isfinite(value) && value >= variable->min && value <= variable->max;
}

fmi2Status sh_check_parameters(sh_instance *instance)
{
    const char *bytes = instance->model;
    char range[64];
    size_t i;

    if (!instance->parameters_unchecked)
        return fmi2OK;
    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        const void *place = bytes + variable->offset;
        const double value =
            variable->type == SH_TYPE_REAL ? *(const double *)place : (double)*(const int *)place;
        if (variable->role != SH_ROLE_FIXED && variable->role != SH_ROLE_TUNABLE)
            continue;
        if (!in_range(variable, value)) {
            write_range(range, sizeof range, variable);
            sh_log(instance, fmi2Error, "Parameter %s = %.9g is out of its range %s.",
                   variable->name, value, range);
            return fmi2Error;
        }
    }
    if (sh_fmu_model.check != NULL && sh_fmu_model.check(instance->model, instance) != fmi2OK)
        return fmi2Error;
    instance->parameters_unchecked = 0;
    return fmi2OK;
}

/* Parameters that are each in their range may together still give numbers that are too large. */
static int outputs_are_finite(sh_instance *instance)
{
    const char *bytes = instance->model;
    size_t i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        double value;

        if (variable->type != SH_TYPE_REAL ||
            (variable->role != SH_ROLE_OUTPUT && variable->role != SH_ROLE_GUESS))
            continue;
        value = *(const double *)(const void *)(bytes + variable->offset);
        if (!isfinite(value)) {
            sh_log(instance, fmi2Error,
                   "Initialisation: output %s = %g is not finite. Look for extreme parameters.",
                   variable->name, value);
            return 0;
        }
    }
    return 1;
}

fmi2Status sh_initialize(sh_instance *instance)
{
    if (!instance->outputs_stale)
        return fmi2OK;
    if (sh_check_parameters(instance) != fmi2OK)
        return fmi2Error;
    sh_fmu_model.initialize(instance->model);
    if (!outputs_are_finite(instance))
        return fmi2Error;
    instance->outputs_stale = 0;
    return fmi2OK;
}
