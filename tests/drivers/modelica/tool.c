/* Functions that a Modelica tool provides for external functions: messages, and an error that ends the model. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include "ModelicaUtilities.h"

void *sigmahat_estimator_new(const double *reals, const int *integers, const double *eta_0);
void *tool_new(const double *reals, const int *integers, const double *eta_0);

extern char tool_messages[4096];
char tool_messages[4096]; /* all messages since it was emptied */

static jmp_buf tool_model;

static void tool_add(const char *string, va_list arguments)
{
    size_t length = 0;

    while (tool_messages[length] != '\0') {
        ++length;
    }
    vsnprintf(tool_messages + length, sizeof tool_messages - length, string, arguments);
}

void ModelicaFormatMessage(const char *string, ...)
{
    va_list arguments;

    va_start(arguments, string);
    tool_add(string, arguments);
    va_end(arguments);
}

void ModelicaFormatError(const char *string, ...)
{
    va_list arguments;

    va_start(arguments, string);
    tool_add(string, arguments);
    va_end(arguments);
    longjmp(tool_model, 1);
}

void ModelicaError(const char *string)
{
    ModelicaFormatError("%s", string);
}

/* The constructor; NULL after an error. */
void *tool_new(const double *reals, const int *integers, const double *eta_0)
{
    return setjmp(tool_model) == 0 ? sigmahat_estimator_new(reals, integers, eta_0) : NULL;
}
