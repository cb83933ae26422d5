/* Sequences of FMI calls with arguments of any kind, for libFuzzer, linked with one FMU.
 *
 * The bytes of the fuzzer choose the calls, one after the other, until there are no more bytes. The
 * sanitizers look for undefined behaviour and leaks. This program checks that a refused step does
 * not change the time, that an accepted one ends where it should, that a restored state gives the
 * same step bit for bit, that damaged states and wrong GUIDs are refused, and that the logger
 * receives valid arguments.
 */
#include "fuzz.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

enum { MAX_TICKS = 50 };

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

void check_message(int status, const char *category, const char *message)
{
    check(status >= SH_OK && status <= SH_ERROR, "the logger got a status that is none");
    check(category != NULL && strncmp(category, "log", 3) == 0,
          "the logger got a strange category");
    check(message != NULL && message[0] != '\0', "the logger got no message");
    check(mbstowcs(NULL, message, 0) != (size_t)-1, "the logger got a message that is not UTF-8");
}

static void set_reals(sequence *s, sh_role first, sh_role last)
{
    uint32_t references[MAX_REFERENCES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, first, last);
    double *values = memory(n * sizeof *values);
    size_t i;

    for (i = 0; i < n; ++i) {
        values[i] = some_real(s, references[i] < sh_fmu_model.count
                                     ? sh_fmu_model.variables[references[i]].start
                                     : 1.0);
    }
    fmi_set_reals(s->instance, seldom(s, 99) ? NULL : references, n, seldom(s, 99) ? NULL : values);
    free(values);
}

static void get_reals(sequence *s)
{
    uint32_t references[MAX_REFERENCES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
    double *values = memory(n * sizeof *values);

    fmi_get_reals(s->instance, references, n, seldom(s, 99) ? NULL : values);
    free(values);
}

/* All Real variables [size: count of the model, 0 for those of another type]. */
static void get_all(const sequence *s, double *values)
{
    uint32_t i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        values[i] = 0.0;
    }
    for (i = 0; i < sh_fmu_model.count; ++i) {
        if (sh_fmu_model.variables[i].type == SH_TYPE_REAL) {
            fmi_get_reals(s->instance, &i, 1, &values[i]);
        }
    }
}

/* A step of at most MAX_TICKS ticks: longer ones are valid, but slow. */
static double short_enough(const sequence *s, double h)
{
    uint32_t i;
    double T = 0.0;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        if (strcmp(sh_fmu_model.variables[i].name, "samplePeriod") == 0 &&
            fmi_get_reals(s->instance, &i, 1, &T) == SH_OK && h / T > MAX_TICKS && h / T <= 1e9) {
            return MAX_TICKS * T;
        }
    }
    return h;
}

static sh_status checked_step(sequence *s, double t, double h)
{
    const double before = fmi_time(s->instance, 0.0);
    const sh_status status = fmi_do_step(s->instance, t, h);
    const double after = fmi_time(s->instance, 0.0);

    check(status == SH_OK || status == SH_WARNING || status == SH_ERROR,
          "a step gave a status it should not know");
    if (status == SH_ERROR) {
        check(before == after, "a refused step moved the time");
        return status;
    }
    check(h > 0.0 && after == t + h, "a step did not end at its end");
    s->longest_step = fmax(s->longest_step, h);
    check(s->forged || after <= s->stop_time + 1e-3 * s->longest_step,
          "a step went beyond the stop time");
    return status;
}

static void some_step(sequence *s)
{
    static const double SIZES[] = {1e-3, 1e-3, 1e-3, 1e-2, 1e-4, 1.0 / 60.0, 1e-9};
    double h = SIZES[below(s, sizeof SIZES / sizeof SIZES[0])], t = s->time;

    if (seldom(s, 32)) {
        t = some_real(s, 1.0);
    }
    if (seldom(s, 32)) {
        h = some_real(s, 1.0);
    }
    checked_step(s, t, short_enough(s, h));
    s->time = fmi_time(s->instance, s->time);
}

/* Runs a step, restores, and runs it again. */
static void step_twice(sequence *s)
{
    const double h = short_enough(s, below(s, 2) ? 1e-3 : 1.0 / 60.0);
    double *first = memory(sh_fmu_model.count * sizeof *first);
    double *second = memory(sh_fmu_model.count * sizeof *second);
    void *state = NULL;

    if (fmi_get_state(s->instance, &state) == SH_OK) {
        const sh_status status = checked_step(s, s->time, h);
        get_all(s, first);
        check(fmi_set_state(s->instance, state) == SH_OK, "a good state was refused");
        check(checked_step(s, s->time, h) == status, "a step repeated gave another status");
        get_all(s, second);
        check(memcmp(first, second, sh_fmu_model.count * sizeof *first) == 0,
              "a step repeated gave another result");
        s->time = fmi_time(s->instance, s->time);
        fmi_free_state(s->instance, &state);
    }
    free(first);
    free(second);
}

static void choose_categories(sequence *s)
{
    static const char *const NAMES[] = {"logAll", "logEvents", "logStatusError",
                                        "logStatusWarning"};
    char text[TEXT];
    const char *const categories[] = {NAMES[below(s, 4)],
                                      seldom(s, 4) ? some_text(s, text) : NAMES[below(s, 4)]};
    const int on = (int)below(s, 2);
    const size_t n = below(s, 3);

    fmi_set_debug_logging(s->instance, on, n, seldom(s, 32) ? NULL : categories);
}

static void reset(sequence *s)
{
    fmi_reset(s->instance);
    s->time = 0.0;
    s->stop_time = INFINITY;
}

static void enter_initialization(sequence *s)
{
    const double start = seldom(s, 4) ? some_real(s, 3.0) : 0.0;
    const int tolerance_defined = (int)below(s, 2), stop_time_defined = seldom(s, 4);
    const double tolerance = some_real(s, 1e-6);
    const double stop_time = start + some_real(s, 0.03); /* some steps */

    if (fmi_enter_initialization(s->instance, tolerance_defined, tolerance, start,
                                 stop_time_defined, stop_time) == SH_OK) {
        s->time = start;
        s->stop_time = stop_time_defined ? stop_time : INFINITY;
    }
}

static void call(sequence *s)
{
    switch (below(s, 32)) {
    case 0:
        reset(s);
        break;
    case 1:
        fmi_terminate(s->instance);
        break;
    case 2:
        choose_categories(s);
        break;
    case 3:
    case 4:
    case 5:
    case 20:
    case 21:
    case 22:
        call_of_this_version(s);
        break;
    case 6:
        enter_initialization(s);
        break;
    case 7:
        fmi_exit_initialization(s->instance);
        break;
    case 8: /* all calls up to the first step */
        reset(s);
        set_reals(s, SH_ROLE_GUESS, SH_ROLE_TUNABLE);
        set_integers(s);
        enter_initialization(s);
        fmi_exit_initialization(s->instance);
        break;
    case 9:
    case 10:
        set_reals(s, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
        break;
    case 11:
    case 12:
        set_reals(s, SH_ROLE_TUNABLE, SH_ROLE_TUNABLE);
        break;
    case 13:
        set_integers(s);
        break;
    case 14:
        get_reals(s);
        break;
    case 15:
        get_integers(s);
        break;
    case 16:
    case 17:
    case 18:
        use_states(s);
        break;
    case 19:
        step_twice(s);
        break;
    case 23:
    case 24:
    case 25:
    case 26:
        set_reals(s, SH_ROLE_INPUT, SH_ROLE_INPUT);
        break;
    default:
        some_step(s);
    }
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    check(setlocale(LC_CTYPE, "C.UTF-8") != NULL, "there is no locale C.UTF-8");
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    sequence s = {0};
    int slot;

    s.next = data;
    s.end = data + size;
    s.stop_time = INFINITY;
    s.instance = some_instance(&s);
    if (!seldom(&s, 2)) { /* most sequences begin with an initialised instance */
        fmi_enter_initialization(s.instance, 0, 0.0, 0.0, 0, 0.0);
        fmi_exit_initialization(s.instance);
    }
    while (s.next < s.end) {
        call(&s);
    }
    for (slot = 0; slot < SLOTS; ++slot) {
        fmi_free_state(s.instance, &s.states[slot]);
    }
    fmi_free_instance(s.instance);
    return 0;
}
