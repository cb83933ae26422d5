/* Every function of FMI 3.0. */
#include "fmi3Functions.h"
#include "shell_calls.h"

enum { ACCESSES = 14 };

/* What the FMU does not have: these functions use only the instance. */
static void call_refused(int which)
{
    switch (which) {
        CASE(11, fmi3EnterEventMode(&instance); fmi3EnterStepMode(&instance);
             fmi3EvaluateDiscreteStates(&instance);
             fmi3UpdateDiscreteStates(&instance, NULL, NULL, NULL, NULL, NULL, NULL);
             fmi3EnterConfigurationMode(&instance); fmi3ExitConfigurationMode(&instance);
             fmi3GetNumberOfVariableDependencies(&instance, 0, NULL);
             fmi3GetVariableDependencies(&instance, 0, NULL, NULL, NULL, NULL, any_size());
             fmi3GetDirectionalDerivative(&instance, NULL, 1, NULL, 1, NULL, 1, NULL, any_size());
             fmi3GetAdjointDerivative(&instance, NULL, 1, NULL, 1, NULL, 1, NULL, any_size());
             fmi3GetOutputDerivatives(&instance, NULL, 1, NULL, NULL, any_size()));
        CASE(12, fmi3GetIntervalDecimal(&instance, NULL, any_size(), NULL, NULL);
             fmi3GetIntervalFraction(&instance, NULL, any_size(), NULL, NULL, NULL);
             fmi3GetShiftDecimal(&instance, NULL, any_size(), NULL);
             fmi3GetShiftFraction(&instance, NULL, any_size(), NULL, NULL);
             fmi3SetIntervalDecimal(&instance, NULL, any_size(), NULL);
             fmi3SetIntervalFraction(&instance, NULL, any_size(), NULL, NULL);
             fmi3SetShiftDecimal(&instance, NULL, any_size(), NULL);
             fmi3SetShiftFraction(&instance, NULL, any_size(), NULL, NULL);
             fmi3ActivateModelPartition(&instance, 0, any_real()));
    default:
        fmi3EnterContinuousTimeMode(&instance);
        fmi3CompletedIntegratorStep(&instance, any_choice(), NULL, NULL);
        fmi3SetTime(&instance, any_real());
        fmi3SetContinuousStates(&instance, NULL, any_size());
        fmi3GetContinuousStateDerivatives(&instance, NULL, any_size());
        fmi3GetEventIndicators(&instance, NULL, any_size());
        fmi3GetContinuousStates(&instance, NULL, any_size());
        fmi3GetNominalsOfContinuousStates(&instance, NULL, any_size());
        fmi3GetNumberOfEventIndicators(&instance, NULL);
        fmi3GetNumberOfContinuousStates(&instance, NULL);
        break;
    }
}

static void call(int which, course here)
{
    const fmi3String categories[] = {"logAll", NULL, any_text()};
    fmi3Boolean handle, end, early;
    fmi3Float64 last;
    fmi3FMUState state = NULL;
    size_t size = 0;

    //@ dynamic_split instance.parameters_unchecked;
    //@ dynamic_split instance.state;
    switch (which) {
        CASE(0, fmi3SetDebugLogging(&instance, any_choice(), any_choice() ? 3 : 0, categories));
        CASE(1, fmi3SetDebugLogging(&instance, any_choice(), any_size(), NULL));
        CASE(2, fmi3EnterInitializationMode(&instance, any_choice(), any_real(), any_real(),
                                            any_choice(), any_real()));
        CASE(3, fmi3ExitInitializationMode(&instance));
        CASE(4, fmi3Terminate(&instance));
        CASE(5, fmi3Reset(&instance));
        CASE(6, fmi3DoStep(&instance, any_real(), any_real(), any_choice(), OR_NULL(&handle),
                           OR_NULL(&end), OR_NULL(&early), OR_NULL(&last)));
        CASE(7, fmi3GetFMUState(&instance, OR_NULL(&state));
             fmi3SerializedFMUStateSize(&instance, state, OR_NULL(&size));
             fmi3FreeFMUState(&instance, OR_NULL(&state)));
        CASE(8, fmi3SetFMUState(&instance, OR_NULL(saved_state())));
        CASE(9,
             fmi3DeserializeFMUState(&instance, any_state(here), HEADER + sizeof(MODEL), &state));
        CASE(10, fmi3SerializeFMUState(&instance, any_state(here), any_block(), any_size());
             fmi3SerializeFMUState(&instance, any_state(here), NULL, any_size()));
    default:
        call_refused(which);
        break;
    }
}

#define ACCESS(number, call)                                                                       \
    case number:                                                                                   \
        return call

static fmi3Status access_values(int which, const uint32_t vr[], size_t n, void *values,
                                size_t count)
{
    switch (which) {
        ACCESS(0, fmi3GetFloat64(&instance, vr, n, values, count));
        ACCESS(1, fmi3SetFloat64(&instance, vr, n, values, count));
        ACCESS(2, fmi3GetInt64(&instance, vr, n, values, count));
        ACCESS(3, fmi3SetInt64(&instance, vr, n, values, count));
        ACCESS(4, fmi3GetInt32(&instance, vr, n, values, count));
        ACCESS(5, fmi3SetInt32(&instance, vr, n, values, count));
        ACCESS(6, fmi3GetBoolean(&instance, vr, n, values, count));
        ACCESS(7, fmi3SetBoolean(&instance, vr, n, values, count));
        ACCESS(8, fmi3GetString(&instance, vr, n, values, count));
        ACCESS(9, fmi3SetString(&instance, vr, n, values, count));
        ACCESS(10, fmi3GetBinary(&instance, vr, n, NULL, values, count));
        ACCESS(11, fmi3SetBinary(&instance, vr, n, NULL, values, count));
        ACCESS(12, fmi3GetClock(&instance, vr, n, values));
    default:
        return fmi3SetClock(&instance, vr, n, values);
    }
}

static void access(int which, const uint32_t vr[], size_t n, int way)
{
    static const size_t SIZES[ACCESSES] = {
        sizeof(fmi3Float64), sizeof(fmi3Float64), sizeof(fmi3Int64),   sizeof(fmi3Int64),
        sizeof(fmi3Int32),   sizeof(fmi3Int32),   sizeof(fmi3Boolean), sizeof(fmi3Boolean)};

    //@ dynamic_split instance.parameters_unchecked;
    switch (way) { /* the right number of values, or too few, or too many */
        CASE(0, access_values(which, vr, n, any_array(n * SIZES[which]), n));
        CASE(1, access_values(which, vr, n, any_array(0), Frama_C_size_t_interval(0, n - 1)));
    default:
        access_values(which, vr, n, any_array(0), Frama_C_size_t_interval(n + 1, SIZE_MAX));
        break;
    }
}

/* The begin of the induction, and its end: what was created is freed, once. */
static void create(const char *token)
{
    sh_instance *created = fmi3InstantiateCoSimulation(
        any_choice() ? "joint" : NULL, any_choice() ? token : NULL, NULL, any_choice(),
        any_choice(), any_choice(), any_choice(), NULL, any_size(), NULL, NULL, NULL);

    if (created != NULL) {
        //@ assert created: created->state == SH_INSTANTIATED;
        //@ assert to_compute: created->outputs_stale == 1 && created->parameters_unchecked == 1;
        fmi3FreeInstance(created);
    }
}

int main(void)
{
    static const version FMI3 = {.calls = 14, .accesses = ACCESSES, .ways = 3};
    static const sh_importer MEMORY = {NULL, NULL, NULL, NULL};
    fmi3Instance none;

    create("another");
    create(sh_fmu_model.guid);
    none =
        fmi3InstantiateModelExchange("joint", NULL, NULL, any_choice(), any_choice(), NULL, NULL);
    fmi3FreeInstance(none);
    none = fmi3InstantiateScheduledExecution("joint", NULL, NULL, any_choice(), any_choice(), NULL,
                                             NULL, NULL, NULL, NULL);
    fmi3FreeInstance(none);
    fmi3SetTime(NULL, any_real());
    every_call(MEMORY, FMI3);
    return 0;
}
