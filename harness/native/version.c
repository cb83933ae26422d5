#include "version.h"

enum { INTERFACE = 1 };

int sh_native_interface(void)
{
    return INTERFACE;
}
