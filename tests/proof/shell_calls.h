/* Every call that an importer can make, in every state of an instance: a proof by induction.
 *
 * The invariant holds when an instance is created or restored, and behind each call if it held before
 * it. So it holds after any number of calls, in any order.
 */
#ifndef SHELL_CALLS_H
#define SHELL_CALLS_H

#include "shell_invariant.h"
#include "simulation.h"

#define CASE(number, ...)                                                                          \
    case number:                                                                                   \
        __VA_ARGS__;                                                                               \
        break

#define OR_NULL(pointer) (any_choice() ? (pointer) : NULL)

/* Calls function `which` of the version of FMI with any arguments that FMI allows, and NULL. */
static void call(int which, course here);

/* The same for functions of variables: n references, and values in one of several ways, in arrays of
 * exactly the announced length.
 */
static void access(int which, const uint32_t references[], size_t n, int way);

typedef struct {
    int calls, accesses, ways; /* how many there are of each */
} version;

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

/* An array of this size with any bytes, at the end of its memory. */
static void *any_array(size_t size)
{
    static char memory[1024];

    Frama_C_make_unknown(memory, sizeof memory);
    return memory + (sizeof memory - size);
}

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

/* Memory for exactly one saved state. */
static void *any_block(void)
{
    static char block[HEADER + sizeof(MODEL)];

    return block;
}

static void every_access(course here, sh_importer importer, int which, int ways)
{
    size_t i, n;
    int way;

    //@ loop unroll 24;
    for (i = 0; i < kind_count; ++i) {
        const uint32_t both[2] = {kinds[i], 0};

        //@ loop unroll 2;
        for (n = 1; n <= 2; ++n) {
            //@ loop unroll 3;
            for (way = 0; way < ways; ++way) {
                any_instance(here, importer);
                access(which, both, n, way);
                expect(importer);
            }
        }
    }
}

static void every_call(sh_importer importer, version fmi)
{
    int i, which;

    find_kinds();
    //@ loop unroll 16;
    for (i = 0; i < COURSES; ++i) {
        //@ loop unroll 30;
        for (which = 0; which < fmi.calls; ++which) {
            any_instance(course_of(i), importer);
            call(which, course_of(i));
            expect(importer);
        }
        //@ loop unroll 30;
        for (which = 0; which < fmi.accesses; ++which) {
            every_access(course_of(i), importer, which, fmi.ways);
        }
    }
    //@ assert reached: \true;
}

#endif
