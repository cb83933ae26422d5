/* Every function of FMI 2.0 for Co-Simulation. */
#include "fmi2Functions.h"
#include "shell_calls.h"

static void call(int which, course here)
{
    const fmi2String categories[] = {"logAll", NULL, any_text()};
    const fmi2StatusKind kind = (fmi2StatusKind)any_int();
    fmi2FMUstate state = NULL;
    size_t size = 0;
    int integer;
    double real;

    //@ dynamic_split instance.parameters_unchecked;
    //@ dynamic_split instance.state;
    switch (which) {
        CASE(0, fmi2SetDebugLogging(&instance, any_choice(), any_choice() ? 3 : 0, categories));
        CASE(1, fmi2SetDebugLogging(&instance, any_choice(), any_size(), NULL));
        CASE(2, fmi2SetupExperiment(&instance, any_int(), any_real(), any_real(), any_int(),
                                    any_real()));
        CASE(3, fmi2EnterInitializationMode(&instance));
        CASE(4, fmi2ExitInitializationMode(&instance));
        CASE(5, fmi2Terminate(&instance));
        CASE(6, fmi2Reset(&instance));
        CASE(7, fmi2DoStep(&instance, any_real(), any_real(), any_int()));
        CASE(8, fmi2CancelStep(&instance));
        CASE(9, fmi2GetStatus(&instance, kind, OR_NULL((fmi2Status *)&integer)));
        CASE(10, fmi2GetRealStatus(&instance, kind, OR_NULL(&real)));
        CASE(11, fmi2GetIntegerStatus(&instance, kind, OR_NULL(&integer)));
        CASE(12, fmi2GetBooleanStatus(&instance, kind, OR_NULL(&integer)));
        CASE(13, fmi2GetStringStatus(&instance, kind, NULL));
        CASE(14, fmi2GetDirectionalDerivative(&instance, NULL, any_size(), NULL, any_size(), NULL,
                                              NULL));
        CASE(15, fmi2GetFMUstate(&instance, OR_NULL(&state));
             fmi2SerializedFMUstateSize(&instance, state, OR_NULL(&size));
             fmi2FreeFMUstate(&instance, OR_NULL(&state)));
        CASE(16, fmi2SetFMUstate(&instance, OR_NULL(saved_state())));
        CASE(17,
             fmi2DeSerializeFMUstate(&instance, any_state(here), HEADER + sizeof(MODEL), &state));
    default:
        fmi2SerializeFMUstate(&instance, any_state(here), any_block(), any_size());
        fmi2SerializeFMUstate(&instance, any_state(here), NULL, any_size());
        break;
    }
}

enum { ACCESSES = 10 };

static void access(int which, const uint32_t vr[], size_t n, int way)
{
    static const size_t SIZES[ACCESSES] = {
        sizeof(fmi2Real),    sizeof(fmi2Real),    sizeof(fmi2Integer), sizeof(fmi2Integer),
        sizeof(fmi2Boolean), sizeof(fmi2Boolean), sizeof(fmi2String),  sizeof(fmi2String),
        sizeof(fmi2Real),    sizeof(fmi2Real)};
    static fmi2Integer orders[2];
    const fmi2Integer *order = orders + (2 - n); /* ends with its memory, too */
    void *values = any_array(n * SIZES[which]);

    Frama_C_make_unknown((char *)orders, sizeof orders);
    //@ dynamic_split instance.parameters_unchecked;
    (void)way; /* one value for each reference */
    switch (which) {
        CASE(0, fmi2GetReal(&instance, vr, n, values));
        CASE(1, fmi2SetReal(&instance, vr, n, values));
        CASE(2, fmi2GetInteger(&instance, vr, n, values));
        CASE(3, fmi2SetInteger(&instance, vr, n, values));
        CASE(4, fmi2GetBoolean(&instance, vr, n, values));
        CASE(5, fmi2SetBoolean(&instance, vr, n, values));
        CASE(6, fmi2GetString(&instance, vr, n, values));
        CASE(7, fmi2SetString(&instance, vr, n, values));
        CASE(8, fmi2SetRealInputDerivatives(&instance, vr, n, order, values));
    default:
        fmi2GetRealOutputDerivatives(&instance, vr, n, order, values);
        break;
    }
}

/* The begin of the induction, and its end: what was created is freed, once. */
static void create(const fmi2CallbackFunctions *functions, const char *guid)
{
    sh_instance *created =
        fmi2Instantiate(any_choice() ? "joint" : NULL, any_choice() ? fmi2CoSimulation : any_int(),
                        any_choice() ? guid : NULL, NULL, functions, any_int(), any_int());

    if (created != NULL) {
        //@ assert created: created->state == SH_INSTANTIATED;
        //@ assert to_compute: created->outputs_stale == 1 && created->parameters_unchecked == 1;
        fmi2FreeInstance(created);
    }
}

int main(void)
{
    static const fmi2CallbackFunctions OWN = {NULL, allocate, release, NULL, NULL};
    static const fmi2CallbackFunctions NONE = {NULL, NULL, NULL, NULL, NULL};
    static const version FMI2 = {.calls = 19, .accesses = ACCESSES, .ways = 1};
    static const sh_importer MEMORY = {NULL, NULL, allocate, release};

    create(NULL, "another");
    create(&NONE, "another");
    create(&NONE, sh_fmu_model.guid);
    create(&OWN, sh_fmu_model.guid);
    fmi2FreeInstance(NULL);
    fmi2DoStep(NULL, any_real(), any_real(), any_int());
    every_call(MEMORY, FMI2);
    return 0;
}
