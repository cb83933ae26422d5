/* Sequences of calls of FMI 2.0 with arguments of any kind, for libFuzzer, linked with one FMU.
 *
 * The bytes of the fuzzer choose the calls, one after the other, until there are no more bytes. Most
 * arguments are valid, because else no sequence would get past its first calls. The sanitizers look
 * for undefined behaviour and leaks. This program checks that a refused step does not change the
 * time, that an accepted one ends where it should, that a restored state gives the same step bit for
 * bit, and that the logger receives valid arguments.
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
    double time; /* next communication point */
} sequence;

static int allocations_left; /* until the allocator of the importer fails */

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
    check(status >= fmi2OK && status <= fmi2Error, "the logger got a status that is none");
    check(category != NULL && strncmp(category, "log", 3) == 0,
          "the logger got a strange category");
    check(message != NULL && message[0] != '\0', "the logger got no message");
    check(mbstowcs(NULL, message, 0) != (size_t)-1, "the logger got a message that is not UTF-8");
    for (c = message; *c != '\0'; ++c) {
        if (*c == '%') {
            check(*++c == '%', "the logger got a message with a conversion");
        }
    }
}

static void *some_instance(sequence *s)
{
    const unsigned how = byte(s);
    fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, &allocations_left};
    char text[TEXT];

    allocations_left = seldom(s, 16) ? (int)below(s, 16) : INT32_MAX;
    if (how & 1) {
        callbacks.logger = logger;
    }
    if (how & 2) {
        callbacks.allocateMemory = allocate;
        callbacks.freeMemory = free;
    }
    return fmi2Instantiate(seldom(s, 4) ? some_text(s, text) : "fuzz",
                           seldom(s, 64) ? fmi2ModelExchange : fmi2CoSimulation,
                           seldom(s, 16) ? some_text(s, text) : sh_fmu_model.guid,
                           how & 4 ? "file:///%s" : NULL, &callbacks, fmi2False,
                           how & 8 ? fmi2True : fmi2False);
}

/* Time of the instance [s], or `otherwise` if it does not tell it now. */
static double now(const sequence *s, double otherwise)
{
    fmi2GetRealStatus(s->instance, fmi2LastSuccessfulTime, &otherwise);
    return otherwise;
}

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

/* Serialises a state, maybe forges it, and reads it back in its place. */
static void read_back(sequence *s, void **state)
{
    void *copy = NULL;
    uint8_t *bytes;
    size_t size = 0;

    if (fmi_state_size(s->instance, *state, &size) != SH_OK) {
        return;
    }
    bytes = memory(size);
    check(fmi_serialize_state(s->instance, *state, bytes, size) == SH_OK,
          "a good state was not serialised");
    if (below(s, 2)) {
        forge(s, bytes, size);
    }
    if (fmi_deserialize_state(s->instance, bytes, size, &copy) == SH_OK) {
        fmi_free_state(s->instance, state);
        *state = copy;
    }
    free(bytes);
}

/* Saves, restores, frees or serialises one of the states. */
static void use_states(sequence *s)
{
    void **state = &s->states[below(s, SLOTS)];

    switch (below(s, 7)) {
    case 0:
    case 1:
        fmi_get_state(s->instance, state);
        break;
    case 2:
    case 3:
        check((fmi_set_state(s->instance, *state) == SH_OK) == (*state != NULL),
              "a good state was refused, or none was taken");
        s->time = now(s, s->time);
        break;
    case 4:
        fmi_free_state(s->instance, state);
        break;
    default:
        read_back(s, state);
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
    const double before = now(s, 0.0);
    const sh_status status = fmi_do_step(s->instance, t, h);
    const double after = now(s, 0.0);

    check(status == SH_OK || status == SH_WARNING || status == SH_ERROR,
          "a step gave a status it should not know");
    check(status == SH_ERROR ? before == after : h > 0.0 && after == t + h,
          "a step did not end at its end, or a refused one moved the time");
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
    s->time = now(s, s->time);
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
        s->time = now(s, s->time);
        fmi_free_state(s->instance, &state);
    }
    free(first);
    free(second);
}

static void reset(sequence *s)
{
    fmi_reset(s->instance);
    s->time = 0.0;
}

/* Tells the experiment, and mostly enters initialisation mode. */
static void set_up(sequence *s)
{
    const double start = seldom(s, 4) ? some_real(s, 3.0) : 0.0;
    const int tolerance_defined = (int)below(s, 2), stop_time_defined = seldom(s, 4);
    const double tolerance = some_real(s, 1e-6);
    const double stop_time = start + some_real(s, 0.03); /* some steps */

    if (fmi2SetupExperiment(s->instance, tolerance_defined, tolerance, start, stop_time_defined,
                            stop_time) == fmi2OK) {
        s->time = start;
    }
    if (!seldom(s, 8)) {
        fmi2EnterInitializationMode(s->instance);
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

static void use_integers(sequence *s, int sets)
{
    uint32_t references[MAX_REFERENCES];
    int values[MAX_REFERENCES];
    fmi2String strings[MAX_REFERENCES] = {0};
    const int boolean = (int)below(s, 2);
    const unsigned types =
        boolean ? SH_TYPE_BOOLEAN : (unsigned)SH_TYPE_INTEGER | SH_TYPE_ENUMERATION;
    const size_t n = some_references(s, references, types, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
    size_t i;

    for (i = 0; i < n; ++i) {
        values[i] = some_integer(s);
    }
    if (sets) {
        (boolean ? fmi2SetBoolean : fmi2SetInteger)(s->instance, references, n, values);
    } else {
        (boolean ? fmi2GetBoolean : fmi2GetInteger)(s->instance, references, n, values);
    }
    if (seldom(s, 32)) {
        fmi2GetString(s->instance, references, n, strings);
        fmi2SetString(s->instance, references, n, strings);
    }
}

static void some_integers(sequence *s)
{
    use_integers(s, (int)below(s, 2));
}

static void set_derivatives(sequence *s)
{
    uint32_t references[MAX_REFERENCES];
    fmi2Integer orders[MAX_REFERENCES];
    double values[MAX_REFERENCES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, SH_ROLE_INPUT,
                                     seldom(s, 16) ? SH_ROLE_TUNABLE : SH_ROLE_INPUT);
    size_t i;

    for (i = 0; i < n; ++i) {
        orders[i] = seldom(s, 32) ? some_integer(s) : 1;
        values[i] = some_real(s, 1.0);
    }
    fmi2SetRealInputDerivatives(s->instance, references, n, seldom(s, 99) ? NULL : orders, values);
}

/* All calls up to the first step. */
static void initialize(sequence *s)
{
    reset(s);
    set_reals(s, SH_ROLE_GUESS, SH_ROLE_TUNABLE);
    use_integers(s, 1);
    set_up(s);
    fmi_exit_initialization(s->instance);
}

static void call(sequence *s)
{
    static const struct {
        unsigned end; /* of its share, of 32 */
        void (*call)(sequence *);
    } CALLS[] = {
        {2, reset},       {3, terminate},       {4, set_up},           {5, exit_initialization},
        {6, initialize},  {8, some_integers},   {9, get_reals},        {10, step_twice},
        {13, use_states}, {21, set_some_reals}, {27, set_derivatives}, {32, some_step}};
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
    s.instance = some_instance(&s);
    if (!seldom(&s, 2)) { /* most sequences begin with an initialised instance */
        fmi_enter_initialization(s.instance);
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
