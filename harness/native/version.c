#include "export.h"

/* To be raised with every change of a function or struct that Python knows; the same number is in
 * harness/sigmahat/fmi/native.py.
 */
enum { INTERFACE = 1 };

SH_EXPORT int sh_native_interface(void);

int sh_native_interface(void)
{
    return INTERFACE;
}
