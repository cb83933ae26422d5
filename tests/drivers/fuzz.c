/* Sequences of FMI calls with arguments of any kind, for libFuzzer, linked with one FMU.
 *
 * The bytes of the fuzzer choose the calls, one after the other, until there are no more bytes. Most
 * arguments are valid, because else no sequence would get past its first calls. The sanitizers look
 * for undefined behaviour and leaks. This program checks that a refused step does not change the
 * time, that an accepted one ends where it should, that a restored state gives the same step bit for
 * bit, that damaged states and wrong GUIDs are refused, and that the logger receives valid arguments.
 */
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi_calls.h"
#include "model.h"

enum { SLOTS = 3, MAX_REFERENCES = 6, TEXT = 16, MAX_TICKS = 50 };
enum { CHECKSUM = 120 }; /* its place in a serialised state, behind the rest of the header */

typedef struct {
    const uint8_t *next, *end; /* the remaining bytes of the fuzzer */
    void *instance;
    void *states[SLOTS];
    double stop_times[SLOTS]; /* of the states */
    double time;              /* next communication point */
    double stop_time;         /* infinite if there is none */
    double longest_step;      /* of all steps so far */
    double steps;             /* number of them */
    int forged;               /* 1: a forged state was taken; its stop time is unknown */
} sequence;

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The next byte; 0 when there are no more bytes. */
static unsigned byte(sequence *s)
{
    return s->next < s->end ? *s->next++ : 0;
}

static unsigned below(sequence *s, unsigned n)
{
    return byte(s) % n;
}

/* 1 in one of n cases; 0 when there are no more bytes. */
static int seldom(sequence *s, unsigned n)
{
    return byte(s) % n == n - 1;
}

static uint64_t bits(sequence *s)
{
    uint64_t all = 0;
    int i;

    for (i = 0; i < 8; ++i) {
        all = all << 8 | byte(s);
    }
    return all;
}

/* Mostly about as large as `size`, sometimes any number. */
static double some_real(sequence *s, double size)
{
    static const double ODD[] = {0.0,  -0.0,     1.0,     -1.0,    NAN,    INFINITY,
                                 1e12, -1e13,    DBL_MAX, DBL_MIN, 5e-324, -INFINITY,
                                 1e-9, -DBL_MAX, 1e300,   1e-300};
    const unsigned choice = byte(s);
    uint64_t pattern;
    double value;

    if (choice < 16) {
        return ODD[choice];
    }
    if (choice == 16) {
        pattern = bits(s);
        memcpy(&value, &pattern, sizeof value);
        return value;
    }
    value = (size != 0.0 ? size : 1.0) * ((double)byte(s) + 1.0) / 128.0;
    return choice < 64 ? -value : value;
}

static int some_integer(sequence *s)
{
    static const int ODD[] = {INT32_MAX, INT32_MIN, -1, 0, 100};

    return seldom(s, 8) ? ODD[below(s, 5)] : 1 + (int)below(s, 3);
}

/* Up to TEXT - 1 bytes of any kind, or NULL. */
static const char *some_text(sequence *s, char *text)
{
    size_t i, length = below(s, TEXT + 1);

    if (length == TEXT) {
        return NULL;
    }
    for (i = 0; i < length; ++i) {
        text[i] = (char)byte(s);
    }
    text[length] = '\0';
    return text;
}

/* Up to MAX_REFERENCES value references, mostly of the types (bits SH_TYPE_*) and of the roles
 * first to last.
 */
static size_t some_references(sequence *s, uint32_t *references, unsigned types, sh_role first,
                              sh_role last)
{
    const size_t n = below(s, MAX_REFERENCES + 1);
    size_t i, k;

    for (i = 0; i < n; ++i) {
        references[i] = (byte(s) << 1 | (byte(s) & 1)) % (unsigned)sh_fmu_model.count;
        for (k = 0; k < sh_fmu_model.count; ++k) {
            const sh_variable *variable = &sh_fmu_model.variables[references[i]];
            if (((unsigned)variable->type & types) && variable->role >= first &&
                variable->role <= last) {
                break;
            }
            references[i] = (uint32_t)((references[i] + 1) % sh_fmu_model.count);
        }
        if (seldom(s, 128)) {
            references[i] = (uint32_t)bits(s);
        }
    }
    return n;
}

/* Memory of exactly this size, so that a sanitizer sees what goes beyond; at least 1 byte. */
static void *memory(size_t size)
{
    void *allocated = malloc(size > 0 ? size : 1);

    check(allocated != NULL, "out of memory");
    return allocated;
}

static void check_message(int status, const char *category, const char *message)
{
    check(status >= SH_OK && status <= SH_ERROR, "the logger got a status that is none");
    check(category != NULL && strncmp(category, "log", 3) == 0,
          "the logger got a strange category");
    check(message != NULL && message[0] != '\0', "the logger got no message");
    check(mbstowcs(NULL, message, 0) != (size_t)-1, "the logger got a message that is not UTF-8");
}

#if SH_FMI == 2
#include "fuzz_fmi2.h"
#else
#include "fuzz_fmi3.h"
#endif

/* Writes the right checksum, as anybody can who has the sources: FNV-1a over all bytes but its own. */
static void sign(uint8_t *bytes, size_t size)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    size_t i;

    memset(bytes + CHECKSUM, 0, sizeof hash);
    for (i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    }
    memcpy(bytes + CHECKSUM, &hash, sizeof hash);
}

/* Changes some numbers of a state, so that only what they mean can show it. */
static void forge(sequence *s, uint8_t *bytes, size_t size)
{
    static const double REALS[] = {NAN, INFINITY, -INFINITY, -1.0, 1e300, -1e300, 5e-324, 0.0};
    unsigned changes;

    for (changes = 1 + below(s, 4); changes > 0; --changes) {
        /* The first part has more choices than the rest, which is mostly large matrices. */
        const size_t place = bits(s) % (below(s, 2) ? size : 4096) % size & ~(size_t)3;
        const double real = REALS[below(s, sizeof REALS / sizeof REALS[0])];
        const int integer = below(s, 2) ? (int)below(s, 80) - 8 : some_integer(s);
        const int is_real = place % 8 == 0 && below(s, 2) && place + sizeof real <= size;

        memcpy(bytes + place, is_real ? (const void *)&real : (const void *)&integer,
               is_real ? sizeof real : sizeof integer);
    }
    sign(bytes, size);
}

/* Damages a serialised state, in a block of its own of exactly the new size. */
static uint8_t *damage(sequence *s, uint8_t *bytes, size_t *size)
{
    if (below(s, 2)) {
        bytes[bits(s) % *size] ^= (uint8_t)(1 + below(s, 255));
        return bytes;
    }
    *size = (below(s, 2) ? bits(s) : byte(s)) % *size;
    bytes = realloc(bytes, *size > 0 ? *size : 1);
    check(bytes != NULL, "out of memory");
    return bytes;
}

/* Serialises a state, maybe damages or forges it, and reads it back in the place of the state. */
static void serialise(sequence *s, unsigned slot)
{
    const unsigned choice = below(s, 5);
    const int damaged = choice == 0, forged = choice > 2;
    void *copy = NULL;
    sh_status status;
    uint8_t *bytes;
    size_t size = 0;

    if (fmi_state_size(s->instance, s->states[slot], &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    if (seldom(s, 16)) {
        check(fmi_serialize_state(s->instance, s->states[slot], bytes, size - 1) == SH_ERROR,
              "a state went into too little room");
    }
    check(fmi_serialize_state(s->instance, s->states[slot], bytes, size) == SH_OK,
          "a good state was not serialised");
    if (damaged) {
        bytes = damage(s, bytes, &size);
    } else if (forged) {
        forge(s, bytes, size);
    }
    status = fmi_deserialize_state(s->instance, bytes, size, &copy);
    check(status == SH_ERROR || !damaged, "a spoilt state was taken");
    if (status == SH_OK) {
        fmi_free_state(s->instance, &s->states[slot]);
        s->states[slot] = copy;
    }
    if (status == SH_OK && forged) {
        s->stop_times[slot] = INFINITY; /* it may have another one, which nobody knows */
        s->forged = 1;
    }
    free(bytes);
}

static void restore(sequence *s, unsigned slot)
{
    unsigned char *block = s->states[slot];

    if (block == NULL) {
        check(fmi_set_state(s->instance, block) == SH_ERROR, "no state was taken");
        return;
    }
    if (seldom(s, 32)) {
        unsigned char *place = block + below(s, 12); /* of what says whose state it is */
        *place ^= 1;
        check(fmi_set_state(s->instance, block) == SH_ERROR, "a foreign state was taken");
        *place ^= 1;
    }
    check(fmi_set_state(s->instance, block) == SH_OK, "a good state was refused");
    s->stop_time = s->stop_times[slot];
    s->time = fmi_time(s->instance, s->time);
}

/* Saves, restores, frees or serialises one of the states. */
static void use_states(sequence *s)
{
    const unsigned slot = below(s, SLOTS);

    switch (below(s, 7)) {
    case 0:
    case 1:
        if (fmi_get_state(s->instance, &s->states[slot]) == SH_OK) {
            s->stop_times[slot] = s->stop_time;
        }
        break;
    case 2:
    case 3:
        restore(s, slot);
        break;
    case 4:
        fmi_free_state(s->instance, &s->states[slot]);
        break;
    default:
        serialise(s, slot);
    }
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

static void set_some_reals(sequence *s)
{
    const unsigned which = below(s, 4); /* mostly inputs */

    set_reals(s, which == 0 ? SH_ROLE_TUNABLE : SH_ROLE_INPUT,
              which < 2 ? SH_ROLE_TUNABLE : SH_ROLE_INPUT);
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
    check(s->forged ||
              after <= s->stop_time + 1e-3 * s->longest_step + DBL_EPSILON * fabs(t) * s->steps,
          "a step went beyond the stop time by more than rounding");
    s->steps += 1.0;
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

static void terminate(sequence *s)
{
    fmi_terminate(s->instance);
}

static void exit_initialization(sequence *s)
{
    fmi_exit_initialization(s->instance);
}

static void some_integers(sequence *s)
{
    use_integers(s, (int)below(s, 2));
}

/* All calls up to the first step. */
static void initialize(sequence *s)
{
    reset(s);
    set_reals(s, SH_ROLE_GUESS, SH_ROLE_TUNABLE);
    use_integers(s, 1);
    enter_initialization(s);
    fmi_exit_initialization(s->instance);
}

static void call(sequence *s)
{
    static const struct {
        unsigned end; /* of its share, of 32 */
        void (*call)(sequence *);
    } CALLS[] = {{1, reset},
                 {2, terminate},
                 {3, choose_categories},
                 {4, enter_initialization},
                 {5, exit_initialization},
                 {6, initialize},
                 {8, some_integers},
                 {9, get_reals},
                 {10, step_twice},
                 {13, use_states},
                 {21, set_some_reals},
                 {27, call_of_this_version},
                 {32, some_step}};
    const unsigned choice = below(s, 32);
    size_t i = 0;

    while (choice >= CALLS[i].end) {
        ++i;
    }
    CALLS[i].call(s);
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
