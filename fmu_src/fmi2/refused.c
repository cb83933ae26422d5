/* Functions of FMI 2.0 for features that the FMUs of this project do not have; compare fmi3/refused.c. */
#include "fmi2Functions.h"
#include "guards.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* only the instance is used */
#endif

/* NOLINTBEGIN(misc-unused-parameters) */

#define REFUSED(Name, missing, ...)                                                                \
    fmi2Status fmi2##Name(__VA_ARGS__)                                                             \
    {                                                                                              \
        return (fmi2Status)sh_refuse_feature(c, "fmi2" #Name, missing);                            \
    }

REFUSED(CancelStep, "steps that run asynchronously", fmi2Component c)
REFUSED(GetRealOutputDerivatives, "derivatives of outputs (maxOutputDerivativeOrder is 0)",
        fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
        fmi2Real value[])
REFUSED(GetDirectionalDerivative, "directional derivatives", fmi2Component c,
        const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
        fmi2Real dvUnknown[])

/* NOLINTEND(misc-unused-parameters) */
