/* Functions of FMI 3.0 for features that the FMUs of this project do not have. FMI demands that such
 * functions exist. Each function in this file fails with a message that names the missing feature.
 */
#include "creation.h"
#include "fmi3Functions.h"
#include "guards.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* only the instance is used */
#endif

/* NOLINTBEGIN(misc-unused-parameters) */

#define REFUSED(Name, missing, ...)                                                                \
    fmi3Status fmi3##Name(__VA_ARGS__)                                                             \
    {                                                                                              \
        return (fmi3Status)sh_refuse_feature(instance, "fmi3" #Name, missing);                     \
    }

#define INSTANCE fmi3Instance instance
#define REFERENCES INSTANCE, const fmi3ValueReference valueReferences[], size_t nValueReferences

REFUSED(EnterEventMode, "event mode (hasEventMode is false)", INSTANCE)
REFUSED(EnterStepMode, "event mode (hasEventMode is false)", INSTANCE)
REFUSED(EvaluateDiscreteStates, "event mode (hasEventMode is false)", INSTANCE)
REFUSED(UpdateDiscreteStates, "event mode (hasEventMode is false)", INSTANCE,
        fmi3Boolean *discreteStatesNeedUpdate, fmi3Boolean *terminateSimulation,
        fmi3Boolean *nominalsOfContinuousStatesChanged,
        fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
        fmi3Float64 *nextEventTime)

REFUSED(EnterConfigurationMode, "structural parameters", INSTANCE)
REFUSED(ExitConfigurationMode, "structural parameters", INSTANCE)

REFUSED(GetNumberOfVariableDependencies, "dependencies of single elements", INSTANCE,
        fmi3ValueReference valueReference, size_t *nDependencies)
REFUSED(GetVariableDependencies, "dependencies of single elements", INSTANCE,
        fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
        fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
        fmi3DependencyKind dependencyKinds[], size_t nDependencies)

REFUSED(GetDirectionalDerivative, "directional derivatives", INSTANCE,
        const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
        size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
        size_t nSensitivity)
REFUSED(GetAdjointDerivative, "adjoint derivatives", INSTANCE, const fmi3ValueReference unknowns[],
        size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
        const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
REFUSED(GetOutputDerivatives, "derivatives of outputs (maxOutputDerivativeOrder is 0)", REFERENCES,
        const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)

REFUSED(GetClock, "clocks", REFERENCES, fmi3Clock values[])
REFUSED(SetClock, "clocks", REFERENCES, const fmi3Clock values[])
REFUSED(GetIntervalDecimal, "clocks", REFERENCES, fmi3Float64 intervals[],
        fmi3IntervalQualifier qualifiers[])
REFUSED(GetIntervalFraction, "clocks", REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
        fmi3IntervalQualifier qualifiers[])
REFUSED(GetShiftDecimal, "clocks", REFERENCES, fmi3Float64 shifts[])
REFUSED(GetShiftFraction, "clocks", REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
REFUSED(SetIntervalDecimal, "clocks", REFERENCES, const fmi3Float64 intervals[])
REFUSED(SetIntervalFraction, "clocks", REFERENCES, const fmi3UInt64 counters[],
        const fmi3UInt64 resolutions[])
REFUSED(SetShiftDecimal, "clocks", REFERENCES, const fmi3Float64 shifts[])
REFUSED(SetShiftFraction, "clocks", REFERENCES, const fmi3UInt64 counters[],
        const fmi3UInt64 resolutions[])
REFUSED(ActivateModelPartition, "clocks", INSTANCE, fmi3ValueReference clockReference,
        fmi3Float64 activationTime)

#define NO_INSTANCE(Kind, words, ...)                                                              \
    fmi3Instance fmi3Instantiate##Kind(fmi3String instanceName, fmi3String instantiationToken,     \
                                       fmi3String resourcePath, fmi3Boolean visible,               \
                                       fmi3Boolean loggingOn,                                      \
                                       fmi3InstanceEnvironment instanceEnvironment, __VA_ARGS__)   \
    {                                                                                              \
        const sh_importer importer = {instanceEnvironment, (void (*)(void))logMessage, NULL,       \
                                      NULL};                                                       \
        return sh_refuse_instance(&importer, "fmi3Instantiate" #Kind, words);                      \
    }

NO_INSTANCE(ModelExchange, "model exchange", fmi3LogMessageCallback logMessage)
NO_INSTANCE(ScheduledExecution, "scheduled execution", fmi3LogMessageCallback logMessage,
            fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
            fmi3UnlockPreemptionCallback unlockPreemption)

REFUSED(EnterContinuousTimeMode, "model exchange", INSTANCE)
REFUSED(CompletedIntegratorStep, "model exchange", INSTANCE,
        fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *enterEventMode,
        fmi3Boolean *terminateSimulation)
REFUSED(SetTime, "model exchange", INSTANCE, fmi3Float64 time)
REFUSED(SetContinuousStates, "model exchange", INSTANCE, const fmi3Float64 continuousStates[],
        size_t nContinuousStates)
REFUSED(GetContinuousStateDerivatives, "model exchange", INSTANCE, fmi3Float64 derivatives[],
        size_t nContinuousStates)
REFUSED(GetEventIndicators, "model exchange", INSTANCE, fmi3Float64 eventIndicators[],
        size_t nEventIndicators)
REFUSED(GetContinuousStates, "model exchange", INSTANCE, fmi3Float64 continuousStates[],
        size_t nContinuousStates)
REFUSED(GetNominalsOfContinuousStates, "model exchange", INSTANCE, fmi3Float64 nominals[],
        size_t nContinuousStates)
REFUSED(GetNumberOfEventIndicators, "model exchange", INSTANCE, size_t *nEventIndicators)
REFUSED(GetNumberOfContinuousStates, "model exchange", INSTANCE, size_t *nContinuousStates)

/* NOLINTEND(misc-unused-parameters) */
