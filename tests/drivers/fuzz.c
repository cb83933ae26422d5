/* Sequences of FMI calls with arguments of any kind, for libFuzzer, linked with one FMU.
 *
 * The bytes of the fuzzer choose the calls, one after the other, until there are no more bytes. Most
 * arguments are valid, because else no sequence would get past its first calls. The sanitizers look
 * for undefined behaviour and leaks. This program checks these rules. A refused step does not change the time, and an
 * accepted step ends at the right time. A restored state gives the same step bit for bit. Damaged states and wrong
 * GUIDs are refused. The logger receives valid arguments.
 */
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"

enum { SLOTS = 3, MAX_REFERENCES = 6, TEXT = 16, MAX_TICKS = 50, BLOCKS = 16 };
enum { CHECKSUM = 120 }; /* place of the checksum, at the end of the header */

static const uint8_t *next, *end; /* the remaining bytes of the fuzzer */
static void *instance;
static void *states[SLOTS];
static void *blocks[BLOCKS]; /* arguments of the present call */
static size_t block_count;

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The next byte; 0 when there are no more bytes. */
static unsigned byte(void)
{
    return next < end ? *next++ : 0;
}

static unsigned below(unsigned n)
{
    return byte() % n;
}

/* 1 in one of n cases; 0 when there are no more bytes. */
static int seldom(unsigned n)
{
    return byte() % n == n - 1;
}

static uint64_t bits(void)
{
    uint64_t all = 0;
    int i;

    for (i = 0; i < 8; ++i) {
        all = all << 8 | byte();
    }
    return all;
}

/* Mostly about as large as `size`, sometimes any number. */
static double some_real(double size)
{
    static const double ODD[] = {0.0,  -0.0,     1.0,     -1.0,    NAN,    INFINITY,
                                 1e12, -1e13,    DBL_MAX, DBL_MIN, 5e-324, -INFINITY,
                                 1e-9, -DBL_MAX, 1e300,   1e-300};
    const unsigned choice = byte();
    uint64_t pattern;
    double value;

    if (choice < 16) {
        return ODD[choice];
    }
    if (choice == 16) {
        pattern = bits();
        memcpy(&value, &pattern, sizeof value);
        return value;
    }
    value = (size != 0.0 ? size : 1.0) * ((double)byte() + 1.0) / 128.0;
    return choice < 64 ? -value : value;
}

static int any_int(void)
{
    static const int ODD[] = {INT32_MAX, INT32_MIN, -1, 0, 100};

    return seldom(8) ? ODD[below(5)] : 1 + (int)below(3);
}

static size_t any_size(void)
{
    return seldom(8) ? (size_t)bits() : below(4);
}

/* Up to TEXT - 1 bytes of any kind, or NULL. */
static const char *some_text(char *text)
{
    size_t i, length = below(TEXT + 1);

    if (length == TEXT) {
        return NULL;
    }
    for (i = 0; i < length; ++i) {
        text[i] = (char)byte();
    }
    text[length] = '\0';
    return text;
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

static int allocations_left; /* number of allocations until the allocator fails */

static void *allocate(size_t count, size_t size)
{
    return allocations_left-- > 0 ? calloc(count, size) : NULL;
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    const char *c;

    check(environment == (fmi2ComponentEnvironment)&allocations_left,
          "the logger got another environment");
    check(name != NULL, "the logger got no name");
    check_message((int)status, category, message);
    for (c = message; *c != '\0'; ++c) {
        if (*c == '%') {
            check(*++c == '%', "the logger got a message with a conversion");
        }
    }
}

static void *some_instance(const char *name, const char *token)
{
    const unsigned how = byte();
    const fmi2CallbackFunctions callbacks = {how & 1 ? logger : NULL, how & 2 ? allocate : NULL,
                                             how & 2 ? free : NULL, NULL, &allocations_left};

    allocations_left = seldom(16) ? (int)below(16) : INT32_MAX;
    return fmi2Instantiate(name, seldom(64) ? fmi2ModelExchange : fmi2CoSimulation, token,
                           how & 4 ? "file:///%s" : NULL, &callbacks, fmi2False,
                           how & 8 ? fmi2True : fmi2False);
}

#else

static int environment; /* that of the importer */

static void logger(fmi3InstanceEnvironment received, fmi3Status status, fmi3String category,
                   fmi3String message)
{
    check(received == &environment, "the logger got another environment");
    check_message((int)status, category, message);
}

static void *some_instance(const char *name, const char *token)
{
    const unsigned how = byte();

    return fmi3InstantiateCoSimulation(name, token, how & 1 ? "/%s" : NULL, (how & 2) != 0,
                                       (how & 4) != 0, fmi3False, (how & 8) != 0, NULL, 0,
                                       &environment, how & 16 ? NULL : logger, NULL);
}

/* How many values are announced for n references: their number, fewer, or more. */
static size_t any_number(size_t n, int way)
{
    return way == 0 ? n : way == 1 ? below((unsigned)n) : n + 1 + (any_size() >> 1);
}

#endif

/* What calls.h asks for. */
#define INSTANCE instance
#define OR_NULL(pointer) (seldom(32) ? NULL : (pointer))

static double any_real(void)
{
    return some_real(1.0);
}

/* An array for the present call: numbers near 1, or small integers of some width. */
static void *any_array(size_t size)
{
    uint8_t *block = memory(size);
    const size_t width = (size_t)1 << below(4);
    const int is_real = size % sizeof(double) == 0 && below(2);
    size_t i;

    check(block_count < BLOCKS, "too many arrays");
    blocks[block_count++] = block;
    for (i = 0; i < size; ++i) {
        block[i] = (uint8_t)(seldom(32) ? byte() : i % width == 0 ? below(4) : 0);
    }
    for (i = 0; is_real && i < size; i += sizeof(double)) {
        const double value = any_real();
        memcpy(block + i, &value, sizeof value);
    }
    return block;
}

/* Written by helpers/fmi_functions.py: call_any(which) calls one of CALLS functions of an instance,
 * access_any(which, vr, n, way) one of ACCESSES functions of variables with n references.
 */
#include "calls.h"

/* The right checksum, which anybody can write who has the sources: FNV-1a over all bytes but its own. */
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
static void forge(uint8_t *bytes, size_t size)
{
    static const double REALS[] = {NAN, INFINITY, -INFINITY, -1.0, 1e300, -1e300, 5e-324, 0.0};
    unsigned changes;

    for (changes = 1 + below(4); changes > 0; --changes) {
        /* The first part has more choices than the rest, which is mostly large matrices. */
        const size_t place = bits() % (below(2) ? size : 4096) % size & ~(size_t)3;
        const double real = REALS[below(sizeof REALS / sizeof REALS[0])];
        const int integer = below(2) ? (int)below(80) - 8 : any_int();
        const int is_real = place % 8 == 0 && below(2) && place + sizeof real <= size;

        memcpy(bytes + place, is_real ? (const void *)&real : (const void *)&integer,
               is_real ? sizeof real : sizeof integer);
    }
    sign(bytes, size);
}

/* Serialises a state, maybe damages or forges it, and reads it back in the place of the state. */
static void serialise(void **state)
{
    const unsigned choice = below(6);
    void *copy = NULL;
    sh_status status;
    uint8_t *bytes;
    size_t size = 0;

    if (fmi_state_size(instance, *state, &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    check(fmi_serialize_state(instance, *state, bytes, size) == SH_OK,
          "a good state was not serialised");
    if (choice == 0) {
        bytes[bits() % size] ^= (uint8_t)(1 + below(255));
    } else if (choice == 1) {
        size = (below(2) ? bits() : byte()) % size;
        bytes = realloc(bytes, size > 0 ? size : 1); /* exactly the new size */
        check(bytes != NULL, "out of memory");
    } else if (choice > 3) {
        forge(bytes, size);
    }
    status = fmi_deserialize_state(instance, bytes, size, &copy);
    check(status == SH_ERROR || choice > 1, "a spoilt state was taken");
    if (status == SH_OK) {
        fmi_free_state(instance, state);
        *state = copy;
    }
    free(bytes);
}

/* Saves, restores, frees or serialises one of the states. */
static void use_states(void)
{
    void **state = &states[below(SLOTS)];

    switch (below(7)) {
    case 0:
    case 1:
        fmi_get_state(instance, state);
        break;
    case 2:
    case 3:
        check((fmi_set_state(instance, *state) == SH_OK) == (*state != NULL),
              "a good state was refused, or none was taken");
        break;
    case 4:
        fmi_free_state(instance, state);
        break;
    default:
        serialise(state);
    }
}

/* Up to MAX_REFERENCES value references, mostly of the types (bits SH_TYPE_*) and of the roles first to last. */
static size_t some_references(uint32_t *references, unsigned types, sh_role first, sh_role last)
{
    const size_t n = below(MAX_REFERENCES + 1);
    size_t i, k;

    for (i = 0; i < n; ++i) {
        references[i] = (byte() << 1 | (byte() & 1)) % (unsigned)sh_fmu_model.count;
        for (k = 0; k < sh_fmu_model.count; ++k) {
            const sh_variable *variable = &sh_fmu_model.variables[references[i]];
            if (((unsigned)variable->type & types) && variable->role >= first &&
                variable->role <= last) {
                break;
            }
            references[i] = (uint32_t)((references[i] + 1) % sh_fmu_model.count);
        }
        if (seldom(128)) {
            references[i] = (uint32_t)bits();
        }
    }
    return n;
}

/* Any function of variables, with references of one type. */
static void some_access(void)
{
    uint32_t references[MAX_REFERENCES];
    const size_t n = some_references(references, 1u << below(4), SH_ROLE_INPUT, SH_ROLE_TUNABLE);
    const int way = SH_FMI == 3 && seldom(4) ? 1 + (int)below(2) : 0; /* only FMI 3.0 has others */

    if (n > 0) {
        access_any((int)below(ACCESSES), references, n, way);
    }
}

static void set_reals(sh_role first, sh_role last)
{
    uint32_t references[MAX_REFERENCES];
    double values[MAX_REFERENCES];
    const size_t n = some_references(references, SH_TYPE_REAL, first, last);
    size_t i;

    for (i = 0; i < n; ++i) {
        values[i] = some_real(
            references[i] < sh_fmu_model.count ? sh_fmu_model.variables[references[i]].start : 1.0);
    }
    fmi_set_reals(instance, references, n, values);
}

static void set_some_reals(void)
{
    const unsigned which = below(4); /* mostly inputs */

    set_reals(which == 0 ? SH_ROLE_TUNABLE : SH_ROLE_INPUT,
              which < 2 ? SH_ROLE_TUNABLE : SH_ROLE_INPUT);
}

static void set_slope(void)
{
    uint32_t references[MAX_REFERENCES];

    if (some_references(references, SH_TYPE_REAL, SH_ROLE_INPUT, SH_ROLE_INPUT) > 0) {
        fmi_set_slope(instance, references[0], any_real());
    }
}

/* A step of at most MAX_TICKS ticks: longer ones are valid, but slow. */
static double short_enough(double h)
{
    uint32_t i;
    double T = 0.0;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        if (strcmp(sh_fmu_model.variables[i].name, "samplePeriod") == 0 &&
            fmi_get_reals(instance, &i, 1, &T) == SH_OK && h / T > MAX_TICKS && h / T <= 1e9) {
            return MAX_TICKS * T;
        }
    }
    return h;
}

static sh_status checked_step(double t, double h)
{
    const double before = fmi_time(instance, 0.0);
    const sh_status status = fmi_do_step(instance, t, h);
    const double after = fmi_time(instance, 0.0);

    check(status == SH_OK || status == SH_WARNING || status == SH_ERROR,
          "a step gave a status it should not know");
    if (status == SH_ERROR) {
        check(before == after, "a refused step moved the time");
    } else {
        check(h > 0.0 && after == t + h, "a step did not end at its end");
    }
    return status;
}

static void some_step(void)
{
    static const double SIZES[] = {1e-3, 1e-3, 1e-3, 1e-2, 1e-4, 1.0 / 60.0, 1e-9};
    const double h = SIZES[below(sizeof SIZES / sizeof SIZES[0])];
    const double t = seldom(32) ? some_real(1.0) : fmi_time(instance, 0.0);

    checked_step(t, short_enough(seldom(32) ? some_real(1.0) : h));
}

/* Runs a step, restores, and runs it again. */
static void step_twice(void)
{
    const double h = short_enough(below(2) ? 1e-3 : 1.0 / 60.0), t = fmi_time(instance, 0.0);
    double first[256] = {0.0}, second[256] = {0.0};
    void *state = NULL;

    if (fmi_get_state(instance, &state) == SH_OK) {
        const sh_status status = checked_step(t, h);
        if (status != SH_ERROR) {
            get_outputs(instance, first);
        }
        check(fmi_set_state(instance, state) == SH_OK, "a good state was refused");
        check(checked_step(t, h) == status, "a step repeated gave another status");
        if (status != SH_ERROR) {
            get_outputs(instance, second);
        }
        check(memcmp(first, second, sizeof first) == 0, "a step repeated gave another result");
        fmi_free_state(instance, &state);
    }
}

static void choose_categories(void)
{
    static const char *const NAMES[] = {"logAll", "logEvents", "logStatusError",
                                        "logStatusWarning"};
    char text[TEXT];
    const char *const categories[] = {NAMES[below(4)],
                                      seldom(4) ? some_text(text) : NAMES[below(4)]};

    fmi_set_debug_logging(instance, (int)below(2), below(3), categories);
}

/* Any function that takes no variables, but for steps and states. */
static void some_call(void)
{
    call_any((int)below(CALLS));
}

/* All calls up to the first step. */
static void initialize(void)
{
    const double start = seldom(4) ? some_real(3.0) : 0.0;
    const double stop = start + some_real(0.03); /* some steps */

    fmi_reset(instance);
    set_reals(SH_ROLE_GUESS, SH_ROLE_TUNABLE);
    some_access();
    fmi_enter_initialization(instance, start, seldom(4), stop);
    fmi_exit_initialization(instance);
}

static void call(void)
{
    static const struct {
        unsigned end; /* of its share, of 32 */
        void (*call)(void);
    } CALLS_AND_STEPS[] = {{1, choose_categories}, {2, some_call},  {3, initialize},
                           {7, some_access},       {8, step_twice}, {12, use_states},
                           {21, set_some_reals},   {25, set_slope}, {32, some_step}};
    const unsigned choice = below(32);
    size_t i = 0;

    while (choice >= CALLS_AND_STEPS[i].end) {
        ++i;
    }
    CALLS_AND_STEPS[i].call();
    while (block_count > 0) {
        free(blocks[--block_count]);
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
    char text[TEXT];
    int slot;

    next = data;
    end = data + size;
    if (seldom(16)) {
        check(some_instance("fuzz", some_text(text)) == NULL, "a wrong GUID was taken");
    }
    instance = some_instance(seldom(4) ? some_text(text) : "fuzz", sh_fmu_model.guid);
    if (!seldom(2)) { /* most sequences begin with an initialised instance */
        fmi_enter_initialization(instance, 0.0, 0, 0.0);
        fmi_exit_initialization(instance);
    }
    while (next < end) {
        call();
    }
    for (slot = 0; slot < SLOTS; ++slot) {
        fmi_free_state(instance, &states[slot]);
    }
    fmi_free_instance(instance);
    return 0;
}
