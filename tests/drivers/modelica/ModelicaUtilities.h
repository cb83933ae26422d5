/* The functions of a Modelica tool that external functions may call, as far as ours do. */
#ifndef MODELICA_UTILITIES_H
#define MODELICA_UTILITIES_H

#if defined(__GNUC__)
#define MODELICA_FORMAT __attribute__((format(printf, 1, 2)))
#define MODELICA_FORMAT_NO_RETURN __attribute__((format(printf, 1, 2), noreturn))
#define MODELICA_NO_RETURN __attribute__((noreturn))
#else
#define MODELICA_FORMAT
#define MODELICA_FORMAT_NO_RETURN
#define MODELICA_NO_RETURN
#endif

void ModelicaError(const char *string) MODELICA_NO_RETURN;
void ModelicaFormatError(const char *string, ...) MODELICA_FORMAT_NO_RETURN;
void ModelicaFormatMessage(const char *string, ...) MODELICA_FORMAT;

#endif
