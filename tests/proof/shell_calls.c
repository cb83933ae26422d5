/* Every call that an importer can make, in every state of an instance: a proof by induction.
 *
 * The invariant holds when an instance is created or restored, and behind each call if it held before
 * it. The invariant therefore holds after any number of calls, in any order. The version of FMI is SH_FMI.
 */
#include "fmi_calls.h"
#include "saved_state.h"
#include "shell_invariant.h"

#define CASE(number, ...)                                                                          \
    case number:                                                                                   \
        __VA_ARGS__;                                                                               \
        break

#define INSTANCE (&instance)
#define OR_NULL(pointer) (any_choice() ? (pointer) : NULL)

enum { WAYS = SH_FMI == 3 ? 3 : 1 }; /* only FMI 3.0 announces a number of values of its own */

/* An array of this size with any bytes, at the end of its memory. */
static void *any_array(size_t size)
{
    static char memory[1024];

    Frama_C_make_unknown(memory, sizeof memory);
    return memory + (sizeof memory - size);
}

/* How many values an importer announces for n references: the right number, or too few, or too many. */
static size_t any_number(size_t n, int way)
{
    return way == 0   ? n
           : way == 1 ? Frama_C_size_t_interval(0, n - 1)
                      : Frama_C_size_t_interval(n + 1, SIZE_MAX);
}

/* The script helpers/fmi_functions.py writes two functions from the header of the standard. The function
 * call_any(which) calls one of CALLS functions of an instance, with any arguments that FMI allows, and NULL. The
 * function access_any(which, vr, n, way) calls one of ACCESSES functions of variables, with n references, and arrays
 * of exactly the announced length.
 */
#include "calls.h"

enum { OWN_CALLS = 5 };

/* A serialised state with any bytes, but of this course. */
static void *any_state(course here)
{
    static char block[HEADER + sizeof(MODEL)];

    Frama_C_make_unknown(block, sizeof block);
    return with_course(block, here.state, here.outputs_stale);
}

/* A state that any instance of this course has saved. */
static void *saved_state(void)
{
    static char block[HEADER + sizeof(MODEL)];
    void *state = block;

    (void)sh_save_state(&instance, &state, "proof");
    Frama_C_make_unknown((char *)&model, sizeof model); /* it has gone on since */
    return block;
}

/* Calls whose arguments depend on each other. */
static void call_own(int which, course here)
{
    static char block[HEADER + sizeof(MODEL)]; /* memory for exactly one saved state */
    const char *categories[] = {"logAll", NULL, any_text()};
    void *state = NULL;
    size_t size = 0;

    //@ dynamic_split instance.parameters_unchecked;
    //@ dynamic_split instance.state;
    switch (which) {
        CASE(0, fmi_set_debug_logging(&instance, any_choice(), 3, categories));
        CASE(1, fmi_get_state(&instance, OR_NULL(&state));
             fmi_state_size(&instance, state, OR_NULL(&size));
             fmi_free_state(&instance, OR_NULL(&state)));
        CASE(2, fmi_set_state(&instance, OR_NULL(saved_state())));
        CASE(3, fmi_deserialize_state(&instance, any_state(here), HEADER + sizeof(MODEL), &state));
    default:
        fmi_serialize_state(&instance, any_state(here), block, any_size());
        fmi_serialize_state(&instance, any_state(here), NULL, any_size());
        break;
    }
}

/* A variable of every type and role, the last one, time, and two that do not exist. */
static uint32_t kinds[24];
static size_t kind_count;

static void find_kinds(void)
{
    static const sh_type TYPES[] = {SH_TYPE_REAL, SH_TYPE_INTEGER, SH_TYPE_ENUMERATION,
                                    SH_TYPE_BOOLEAN};
    const uint32_t count = (uint32_t)sh_fmu_model.count;
    uint32_t i;
    int type, role;

    //@ loop unroll 4;
    for (type = 0; type < 4; ++type) {
        //@ loop unroll 5;
        for (role = SH_ROLE_INPUT; role <= SH_ROLE_TUNABLE; ++role) {
            //@ loop unroll 300;
            for (i = 0; i < count; ++i) {
                if (sh_fmu_model.variables[i].type == TYPES[type] &&
                    (int)sh_fmu_model.variables[i].role == role) {
                    kinds[kind_count++] = i;
                    break;
                }
            }
        }
    }
    kinds[kind_count++] = count - 1;
    kinds[kind_count++] = count;
    kinds[kind_count++] = count + 1;
    kinds[kind_count++] = UINT32_MAX;
}

static void every_access(course here, sh_importer importer, int which)
{
    size_t i, n;
    int way;

    //@ loop unroll 24;
    for (i = 0; i < kind_count; ++i) {
        const uint32_t both[2] = {kinds[i], 0};

        //@ loop unroll 2;
        for (n = 1; n <= 2; ++n) {
            //@ loop unroll 3;
            for (way = 0; way < WAYS; ++way) {
                any_instance(here, importer);
                access_any(which, both, n, way);
                expect(importer);
            }
        }
    }
}

static void every_call(sh_importer importer)
{
    int i, which;

    find_kinds();
    //@ loop unroll 16;
    for (i = 0; i < COURSES; ++i) {
        //@ loop unroll 60;
        for (which = 0; which < OWN_CALLS + CALLS; ++which) {
            any_instance(course_of(i), importer);
            if (which < OWN_CALLS) {
                call_own(which, course_of(i));
            } else {
                call_any(which - OWN_CALLS);
            }
            expect(importer);
        }
        //@ loop unroll 60;
        for (which = 0; which < ACCESSES; ++which) {
            every_access(course_of(i), importer, which);
        }
    }
    //@ assert reached: \true;
}

/* The begin of the induction, and its end: each created instance is freed once. */
static void free_created(sh_instance *created)
{
    if (created != NULL) {
        //@ assert created: created->state == SH_INSTANTIATED;
        //@ assert to_compute: created->outputs_stale == 1 && created->parameters_unchecked == 1;
        fmi_free_instance(created);
    }
}

#if SH_FMI == 2
static void create(const char *instance_name, const fmi2CallbackFunctions *functions,
                   const char *guid)
{
    free_created(fmi2Instantiate(OR_NULL(instance_name),
                                 any_choice() ? fmi2CoSimulation : any_int(), OR_NULL(guid), NULL,
                                 functions, any_int(), any_int()));
}

static void create_all(void)
{
    static const fmi2CallbackFunctions OWN = {NULL, allocate, release, NULL, NULL};
    static const fmi2CallbackFunctions NONE = {NULL, NULL, NULL, NULL, NULL};

    create("joint", NULL, "another");
    create("joint", &NONE, "another");
    create("joint", &NONE, sh_fmu_model.guid);
    create("joint", &OWN, sh_fmu_model.guid);
    create("", &OWN, sh_fmu_model.guid);
}
#else
static void create(const char *instance_name, const char *token)
{
    free_created(fmi3InstantiateCoSimulation(OR_NULL(instance_name), OR_NULL(token), NULL,
                                             any_choice(), any_choice(), any_choice(), any_choice(),
                                             NULL, any_size(), NULL, NULL, NULL));
}

static void create_all(void)
{
    create("joint", "another");
    create("joint", sh_fmu_model.guid);
    create("", sh_fmu_model.guid);
    free_created(
        fmi3InstantiateModelExchange("joint", NULL, NULL, any_choice(), any_choice(), NULL, NULL));
    free_created(fmi3InstantiateScheduledExecution("joint", NULL, NULL, any_choice(), any_choice(),
                                                   NULL, NULL, NULL, NULL, NULL));
}
#endif

int main(void)
{
    static const sh_importer OWN = {NULL, NULL, allocate, release};
    static const sh_importer NONE = {NULL, NULL, NULL, NULL};

    create_all();
    fmi_free_instance(NULL);
    fmi_terminate(NULL);
    every_call(SH_FMI == 2 ? OWN : NONE);
    return 0;
}
