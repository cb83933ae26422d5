/* Which functions and structs this library has. */
#ifndef SH_VERSION_H
#define SH_VERSION_H

#include "export.h"

/* A number that is raised with every change of a function or struct that Python knows. The same
 * number is in harness/sigmahat/fmi/native.py.
 */
SH_EXPORT int sh_native_interface(void);

#endif
