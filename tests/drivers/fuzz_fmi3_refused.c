/* FMI 3.0: types that no variable has, and the functions for what these FMUs do not have. All have to
 * be refused.
 */
#include "drive.h"
#include "fmi3Functions.h"
#include "fuzz.h"

#define USE(Type)                                                                                  \
    {                                                                                              \
        fmi3##Type values[MAX_REFERENCES] = {0};                                                   \
        check(fmi3Get##Type(instance, references, n, values, n) == fmi3Error,                      \
              "a variable of type " #Type " was found");                                           \
        check(fmi3Set##Type(instance, references, n, values, n) == fmi3Error,                      \
              "a variable of type " #Type " was set");                                             \
    }

void use_types_of_no_variable(sequence *s)
{
    void *const instance = s->instance;
    uint32_t references[MAX_REFERENCES] = {0};
    const fmi3Clock clocks[MAX_REFERENCES] = {0};
    size_t sizes[MAX_REFERENCES] = {0};
    fmi3Clock active[MAX_REFERENCES];
    fmi3Binary binaries[MAX_REFERENCES] = {0};
    size_t n = some_references(s, references, ~0u, SH_ROLE_INPUT, SH_ROLE_TUNABLE);

    if (n == 0) {
        n = 1;
    }
    if (seldom(s, 8)) {
        references[0] = (uint32_t)sh_fmu_model.count; /* time */
    }
    USE(Float32)
    USE(Int8)
    USE(UInt8)
    USE(Int16)
    USE(UInt16)
    USE(UInt32)
    USE(UInt64)
    USE(String)
    check(fmi3GetBinary(instance, references, n, sizes, binaries, n) == fmi3Error &&
              fmi3SetBinary(instance, references, n, sizes, binaries, n) == fmi3Error,
          "a variable of type Binary was found");
    check(fmi3GetClock(instance, references, n, active) == fmi3Error &&
              fmi3SetClock(instance, references, n, clocks) == fmi3Error,
          "a clock was found");
}

void call_what_is_not_provided(sequence *s)
{
    void *const instance = s->instance;
    const fmi3ValueReference reference = byte(s);
    const fmi3Int32 order = 1;
    fmi3IntervalQualifier qualifier;
    fmi3Boolean yes = fmi3False;
    fmi3UInt64 counter = 0;
    double value = 0.0;
    size_t n = 0;
    const fmi3Status statuses[] = {
        fmi3EnterEventMode(instance),
        fmi3EnterStepMode(instance),
        fmi3EvaluateDiscreteStates(instance),
        fmi3UpdateDiscreteStates(instance, &yes, &yes, &yes, &yes, &yes, &value),
        fmi3EnterConfigurationMode(instance),
        fmi3ExitConfigurationMode(instance),
        fmi3GetNumberOfVariableDependencies(instance, reference, &n),
        fmi3GetVariableDependencies(instance, reference, NULL, NULL, NULL, NULL, byte(s)),
        fmi3GetDirectionalDerivative(instance, &reference, 1, &reference, 1, &value, 1, &value, 1),
        fmi3GetAdjointDerivative(instance, &reference, 1, &reference, 1, &value, 1, &value, 1),
        fmi3GetOutputDerivatives(instance, &reference, 1, &order, &value, 1),
        fmi3GetIntervalDecimal(instance, &reference, 1, &value, &qualifier),
        fmi3GetIntervalFraction(instance, &reference, 1, &counter, &counter, &qualifier),
        fmi3GetShiftDecimal(instance, &reference, 1, &value),
        fmi3GetShiftFraction(instance, &reference, 1, &counter, &counter),
        fmi3SetIntervalDecimal(instance, &reference, 1, &value),
        fmi3SetIntervalFraction(instance, &reference, 1, &counter, &counter),
        fmi3SetShiftDecimal(instance, &reference, 1, &value),
        fmi3SetShiftFraction(instance, &reference, 1, &counter, &counter),
        fmi3ActivateModelPartition(instance, reference, s->time),
        fmi3EnterContinuousTimeMode(instance),
        fmi3CompletedIntegratorStep(instance, fmi3True, &yes, &yes),
        fmi3SetTime(instance, s->time),
        fmi3SetContinuousStates(instance, &value, 1),
        fmi3GetContinuousStateDerivatives(instance, &value, 1),
        fmi3GetEventIndicators(instance, &value, 1),
        fmi3GetContinuousStates(instance, &value, 1),
        fmi3GetNominalsOfContinuousStates(instance, &value, 1),
        fmi3GetNumberOfEventIndicators(instance, &n),
        fmi3GetNumberOfContinuousStates(instance, &n),
    };
    size_t i;

    for (i = 0; i < sizeof statuses / sizeof statuses[0]; ++i) {
        check(statuses[i] == fmi3Error, "something was done that is not provided");
    }
    check(!yes && value == 0.0 && counter == 0 && n == 0, "a refused function gave a result");
}
