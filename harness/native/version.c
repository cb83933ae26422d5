#include "version.h"

enum { INTERFACE = 2 };

int sh_native_interface(void)
{
    return INTERFACE;
}
