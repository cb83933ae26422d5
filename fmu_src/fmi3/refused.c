/* Functions of FMI 3.0 for features that the FMUs of this project do not have. FMI demands that such
 * functions exist. Each function in this file fails with a message that names the missing feature.
 */
#include "fmi3Functions.h"
#include "simulation.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* only the instance is used */
#endif

/* NOLINTBEGIN(misc-unused-parameters) */

#define REFUSED(Name, missing)                                                                     \
    fmi3Status fmi3##Name(fmi3Instance instance)                                                   \
    {                                                                                              \
        return (fmi3Status)sh_refuse_feature(instance, "fmi3" #Name, missing);                     \
    }

#define REFUSED_WITH(Name, missing, ...)                                                           \
    fmi3Status fmi3##Name(fmi3Instance instance, __VA_ARGS__)                                      \
    {                                                                                              \
        return (fmi3Status)sh_refuse_feature(instance, "fmi3" #Name, missing);                     \
    }

#define REFERENCES const fmi3ValueReference valueReferences[], size_t nValueReferences

REFUSED(EnterEventMode, "event mode (hasEventMode is false)")
REFUSED(EnterStepMode, "event mode (hasEventMode is false)")
REFUSED(EvaluateDiscreteStates, "event mode (hasEventMode is false)")
REFUSED_WITH(UpdateDiscreteStates, "event mode (hasEventMode is false)",
             fmi3Boolean *discreteStatesNeedUpdate, fmi3Boolean *terminateSimulation,
             fmi3Boolean *nominalsOfContinuousStatesChanged,
             fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
             fmi3Float64 *nextEventTime)

REFUSED(EnterConfigurationMode, "structural parameters")
REFUSED(ExitConfigurationMode, "structural parameters")

REFUSED_WITH(GetNumberOfVariableDependencies, "dependencies of single elements",
             fmi3ValueReference valueReference, size_t *nDependencies)
REFUSED_WITH(GetVariableDependencies, "dependencies of single elements",
             fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
             fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
             fmi3DependencyKind dependencyKinds[], size_t nDependencies)

REFUSED_WITH(GetDirectionalDerivative, "directional derivatives",
             const fmi3ValueReference unknowns[], size_t nUnknowns,
             const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
             size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
REFUSED_WITH(GetAdjointDerivative, "adjoint derivatives", const fmi3ValueReference unknowns[],
             size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
             const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
REFUSED_WITH(GetOutputDerivatives, "derivatives of outputs (maxOutputDerivativeOrder is 0)",
             REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)

REFUSED_WITH(GetBinary, "variables of type Binary", REFERENCES, size_t valueSizes[],
             fmi3Binary values[], size_t nValues)
REFUSED_WITH(SetBinary, "variables of type Binary", REFERENCES, const size_t valueSizes[],
             const fmi3Binary values[], size_t nValues)

REFUSED_WITH(GetClock, "clocks", REFERENCES, fmi3Clock values[])
REFUSED_WITH(SetClock, "clocks", REFERENCES, const fmi3Clock values[])
REFUSED_WITH(GetIntervalDecimal, "clocks", REFERENCES, fmi3Float64 intervals[],
             fmi3IntervalQualifier qualifiers[])
REFUSED_WITH(GetIntervalFraction, "clocks", REFERENCES, fmi3UInt64 counters[],
             fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
REFUSED_WITH(GetShiftDecimal, "clocks", REFERENCES, fmi3Float64 shifts[])
REFUSED_WITH(GetShiftFraction, "clocks", REFERENCES, fmi3UInt64 counters[],
             fmi3UInt64 resolutions[])
REFUSED_WITH(SetIntervalDecimal, "clocks", REFERENCES, const fmi3Float64 intervals[])
REFUSED_WITH(SetIntervalFraction, "clocks", REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[])
REFUSED_WITH(SetShiftDecimal, "clocks", REFERENCES, const fmi3Float64 shifts[])
REFUSED_WITH(SetShiftFraction, "clocks", REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[])
REFUSED_WITH(ActivateModelPartition, "clocks", fmi3ValueReference clockReference,
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

REFUSED(EnterContinuousTimeMode, "model exchange")
REFUSED_WITH(CompletedIntegratorStep, "model exchange",
             fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *enterEventMode,
             fmi3Boolean *terminateSimulation)
REFUSED_WITH(SetTime, "model exchange", fmi3Float64 time)
REFUSED_WITH(SetContinuousStates, "model exchange", const fmi3Float64 continuousStates[],
             size_t nContinuousStates)
REFUSED_WITH(GetContinuousStateDerivatives, "model exchange", fmi3Float64 derivatives[],
             size_t nContinuousStates)
REFUSED_WITH(GetEventIndicators, "model exchange", fmi3Float64 eventIndicators[],
             size_t nEventIndicators)
REFUSED_WITH(GetContinuousStates, "model exchange", fmi3Float64 continuousStates[],
             size_t nContinuousStates)
REFUSED_WITH(GetNominalsOfContinuousStates, "model exchange", fmi3Float64 nominals[],
             size_t nContinuousStates)
REFUSED_WITH(GetNumberOfEventIndicators, "model exchange", size_t *nEventIndicators)
REFUSED_WITH(GetNumberOfContinuousStates, "model exchange", size_t *nContinuousStates)

/* NOLINTEND(misc-unused-parameters) */
