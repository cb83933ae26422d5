/* Every call that an importer can make, in every state of an instance: a proof by induction.
 *
 * The invariant holds when an instance is created or restored, and behind each call if it held before
 * it. So it holds after any number of calls, in any order.
 */
#ifndef SHELL_CALLS_H
#define SHELL_CALLS_H

#include <stdlib.h>

#include "shell_invariant.h"
#include "state_block.h"

/* Calls function `which` of the version of FMI with any arguments that FMI allows, and NULL. */
static void call(int which, course here);

/* The same for functions of variables: n references, and values in one of several ways, in arrays of
 * exactly the announced length.
 */
static void access(int which, const uint32_t references[], size_t n, int way);

typedef struct {
    int calls, accesses, ways; /* how many there are of each */
} version;

/* A variable of every kind of StiffnessEstimator: an input, a guess, an output, an array, an element of
 * it, the three kinds of outputs that are no Real, parameters of each type, the last variable, time,
 * and two that do not exist.
 */
static const uint32_t EVERY_KIND[] = {0,  5,  9,  14,  15,  72,  73,         79,
                                      80, 97, 98, 165, 166, 167, 4294967295u};

/* An array of this size with any bytes, at the end of its memory. */
static void *any_array(size_t size)
{
    static char memory[1024];

    Frama_C_make_unknown(memory, sizeof memory);
    return memory + (sizeof memory - size);
}

/* A saved state with any bytes, but of this course. */
static void *any_state(course here)
{
    static char block[HEADER + sizeof(MODEL)];

    Frama_C_make_unknown(block, sizeof block);
    return with_course(block, here.state, here.outputs_stale, here.parameters_unchecked);
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

    //@ loop unroll 20;
    for (i = 0; i < sizeof EVERY_KIND / sizeof EVERY_KIND[0]; ++i) {
        const uint32_t both[2] = {EVERY_KIND[i], 0};

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
