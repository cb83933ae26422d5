/* The invariant of an instance between any two calls of its importer.
 *
 * The instance is in one of 16 courses, and its pointers have not changed since its creation. Parameters that need no
 * check have passed it. An estimator that the next step uses was made by its own functions, or has passed its check.
 */
#ifndef SHELL_INVARIANT_H
#define SHELL_INVARIANT_H

#include <string.h>

#include "shell_importer.h"

/* The replacements of a model's parts (shell_library.c, shell_equations.c) mark parameters and states that may be
 * used, and prove the marks.
 */
void mark_checked(MODEL *model);
void mark_sound(MODEL *model);
void expect_checked(const MODEL *model);
void expect_sound(const MODEL *model);

/*@ requires \valid(instance) && \valid_read(format);
    assigns \nothing; */
void sh_report(sh_instance *instance, sh_status status, const char *format, ...);
/*@ requires \valid(instance) && \valid_read(format);
    assigns instance->warned; */
void sh_warn_once(sh_instance *instance, const char *format, ...);

/* Where a simulation stands. */
typedef struct {
    sh_state state;
    int outputs_stale;
    int parameters_unchecked;
} course;

enum { COURSES = 16 };

enum { HEADER = 128 }; /* bytes of a saved state before those of its model */

static MODEL model;
static char name[] = "x";
static sh_instance instance;

static course course_of(int i)
{
    static const sh_state STATES[] = {SH_INSTANTIATED, SH_INITIALIZATION, SH_STEP, SH_TERMINATED};
    const course found = {STATES[i % 4], i / 4 % 2, i / 8};

    return found;
}

static int is_initialized(sh_state state, int outputs_stale)
{
    return state == SH_STEP || (state == SH_INITIALIZATION && !outputs_stale);
}

/* A serialised state, in which it is written where its simulation stands. */
static void *with_course(char *block, unsigned state, int outputs_stale)
{
    enum { PLACE_OF_STATE = 12, PLACE_OF_FLAG = 112 };
    const uint32_t flag = (uint32_t)outputs_stale;

    (void)memcpy(block + PLACE_OF_STATE, &state, sizeof state);
    (void)memcpy(block + PLACE_OF_FLAG, &flag, sizeof flag);
    return block;
}

/* Makes `instance` any instance of this course. */
static void any_instance(course here, sh_importer importer)
{
    Frama_C_make_unknown((char *)&model, sizeof model);
    if (!here.parameters_unchecked) {
        mark_checked(&model);
    }
    if (is_initialized(here.state, here.outputs_stale)) {
        mark_sound(&model);
    }
    instance.importer = importer;
    instance.name = name;
    instance.categories = (unsigned)any_int();
    instance.state = here.state;
    instance.time = any_real();
    instance.stop_time = any_real();
    instance.steps = any_real();
    instance.previous_step = any_real();
    instance.outputs_stale = here.outputs_stale;
    instance.parameters_unchecked = here.parameters_unchecked;
    instance.slopes_end = any_size();
    if (instance.slopes_end > sh_fmu_model.count) {
        instance.slopes_end = sh_fmu_model.count;
    }
    instance.warned = any_choice();
    instance.model = &model;
}

/* The condition after a call. It is compared in C: Eva uses the results of a function again where all
 * is the same that its code reads, and an assertion is no code.
 */
static void expect(sh_importer importer)
{
    const sh_state state = instance.state;
    const int stale = instance.outputs_stale, unchecked = instance.parameters_unchecked;

    if (instance.model != &model || instance.name != name) {
        //@ assert pointers: \false;
    }
    if (instance.importer.allocate != importer.allocate ||
        instance.importer.release != importer.release) {
        //@ assert memory: \false;
    }
    if (state != SH_INSTANTIATED && state != SH_INITIALIZATION && state != SH_STEP &&
        state != SH_TERMINATED) {
        //@ assert state: \false;
    }
    if (instance.slopes_end > sh_fmu_model.count) {
        //@ assert slopes: \false;
    }
    if ((stale != 0 && stale != 1) || (unchecked != 0 && unchecked != 1)) {
        //@ assert flags: \false;
    }
    if (!unchecked) {
        expect_checked(&model);
    }
    if (is_initialized(state, stale)) {
        expect_sound(&model);
    }
}

#endif
