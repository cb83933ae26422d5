/* The functions of a Modelica tool that external functions may call, as far as ours do. */
#ifndef MODELICA_UTILITIES_H
#define MODELICA_UTILITIES_H

void ModelicaError(const char *string) __attribute__((noreturn));
void ModelicaFormatError(const char *string, ...) __attribute__((format(printf, 1, 2), noreturn));
void ModelicaFormatMessage(const char *string, ...) __attribute__((format(printf, 1, 2)));

#endif
