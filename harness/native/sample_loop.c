#include "sample_loop.h"

static fmi2Status make(const sh_call *call, char *row)
{
    fmi2Component fmu = call->component;
    const fmi2Real *step = (const fmi2Real *)(void *)row;

    switch (call->kind) {
    case SH_CALL_SET_REAL:
        return ((fmi2SetRealTYPE *)call->function)(fmu, call->references, call->count, step);
    case SH_CALL_SET_SLOPES:
        return ((fmi2SetRealInputDerivativesTYPE *)call->function)(fmu, call->references,
                                                                   call->count, call->orders, step);
    case SH_CALL_DO_STEP:
        return ((fmi2DoStepTYPE *)call->function)(fmu, step[0], step[1], fmi2True);
    case SH_CALL_GET_REAL:
        return ((fmi2GetRealTYPE *)call->function)(fmu, call->references, call->count,
                                                   (fmi2Real *)(void *)row);
    case SH_CALL_GET_INTEGER: /* fmi2Boolean is the same type */
        return ((fmi2GetIntegerTYPE *)call->function)(fmu, call->references, call->count,
                                                      (fmi2Integer *)(void *)row);
    default:
        return fmi2Error;
    }
}

size_t sh_sample_loop(const sh_call *calls, size_t count, size_t first, size_t end)
{
    size_t i, k;

    for (k = first; k < end; ++k) {
        for (i = 0; i < count; ++i) {
            if (make(&calls[i], calls[i].rows + k * calls[i].stride) > fmi2Warning) {
                return i;
            }
        }
    }
    return count;
}

int sh_native_interface(void)
{
    return 4;
}
