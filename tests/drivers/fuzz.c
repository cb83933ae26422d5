/* Sequences of FMI calls with arguments of any kind, for libFuzzer, linked with one FMU.
 *
 * The bytes of the fuzzer choose the calls, one after the other, until there are no more bytes.
 * Most arguments are valid, because else no sequence would get past its first calls. The sanitizers
 * look for undefined behaviour and leaks. This program checks that a refused step does not change
 * the time, that a restored state gives the same step bit for bit, that damaged states and wrong
 * GUIDs are refused, and that the logger receives valid arguments.
 */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "model.h"

enum { SLOTS = 3, MAX_VALUES = 6, MAX_TICKS = 50, TEXT = 16 };

typedef struct {
    const uint8_t *next, *end; /* the remaining bytes of the fuzzer */
    fmi2Component instance;
    fmi2FMUstate states[SLOTS];
    double time; /* next communication point */
} sequence;

static int allocations_left; /* until the allocator of the importer fails */

static void check(int condition, const char *what)
{
    if (condition)
        return;
    fprintf(stderr, "fuzz: %s\n", what);
    abort();
}

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

    for (i = 0; i < 8; ++i)
        all = all << 8 | byte(s);
    return all;
}

/* A double: mostly about as large as `size`, sometimes any number. */
static double some_real(sequence *s, double size)
{
    static const double ODD[] = {0.0,  -0.0,     1.0,     -1.0,    NAN,    INFINITY,
                                 1e12, -1e13,    DBL_MAX, DBL_MIN, 5e-324, -INFINITY,
                                 1e-9, -DBL_MAX, 1e300,   1e-300};
    const unsigned choice = byte(s);
    uint64_t pattern;
    double value;

    if (choice < 16)
        return ODD[choice];
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

/* A text of up to TEXT - 1 bytes of any kind, or NULL. */
static const char *some_text(sequence *s, char *text)
{
    size_t i, length = below(s, TEXT + 1);

    if (length == TEXT)
        return NULL;
    for (i = 0; i < length; ++i)
        text[i] = (char)byte(s);
    text[length] = '\0';
    return text;
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
    check(name != NULL && strncmp(category, "log", 3) == 0 && status <= fmi2Error &&
              message[0] != '\0',
          "the logger got a strange name, category, status or message");
    for (c = message; *c != '\0'; ++c)
        if (*c == '%')
            check(*++c == '%', "the logger got a message with a conversion");
}

/* Up to MAX_VALUES value references, mostly of the type and the roles first to last. */
static size_t some_references(sequence *s, fmi2ValueReference *references, sh_type type,
                              sh_role first, sh_role last)
{
    const size_t n = below(s, MAX_VALUES + 1);
    size_t i, k;

    for (i = 0; i < n; ++i) {
        references[i] = (byte(s) << 1 | (byte(s) & 1)) % (unsigned)sh_fmu_model.count;
        for (k = 0; k < sh_fmu_model.count; ++k) {
            const sh_variable *variable = &sh_fmu_model.variables[references[i]];
            if (variable->type == type && variable->role >= first && variable->role <= last)
                break;
            references[i] = (fmi2ValueReference)((references[i] + 1) % sh_fmu_model.count);
        }
        if (seldom(s, 128))
            references[i] = (fmi2ValueReference)bits(s);
    }
    return n;
}

static void set_real(sequence *s, sh_role first, sh_role last)
{
    fmi2ValueReference references[MAX_VALUES];
    double values[MAX_VALUES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, first, last);
    size_t i;

    for (i = 0; i < n; ++i)
        values[i] = some_real(s, references[i] < sh_fmu_model.count
                                     ? sh_fmu_model.variables[references[i]].start
                                     : 1.0);
    fmi2SetReal(s->instance, seldom(s, 99) ? NULL : references, n, seldom(s, 99) ? NULL : values);
}

static void set_derivatives(sequence *s)
{
    fmi2ValueReference references[MAX_VALUES];
    fmi2Integer orders[MAX_VALUES];
    double values[MAX_VALUES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, SH_ROLE_INPUT,
                                     seldom(s, 16) ? SH_ROLE_TUNABLE : SH_ROLE_INPUT);
    size_t i;

    for (i = 0; i < n; ++i) {
        orders[i] = seldom(s, 32) ? some_integer(s) : 1;
        values[i] = some_real(s, 1.0);
    }
    fmi2SetRealInputDerivatives(s->instance, references, n, seldom(s, 99) ? NULL : orders, values);
}

static void set_int(sequence *s)
{
    fmi2ValueReference references[MAX_VALUES];
    int values[MAX_VALUES];
    const sh_type type = below(s, 2) ? SH_TYPE_BOOLEAN : SH_TYPE_INTEGER;
    const size_t n = some_references(s, references, type, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
    size_t i;

    for (i = 0; i < n; ++i)
        values[i] = some_integer(s);
    if (type == SH_TYPE_INTEGER)
        fmi2SetInteger(s->instance, references, n, values);
    else
        fmi2SetBoolean(s->instance, references, n, values);
}

static void get(sequence *s)
{
    fmi2ValueReference references[MAX_VALUES];
    double reals[MAX_VALUES];
    int ints[MAX_VALUES];
    fmi2String strings[MAX_VALUES] = {0};
    const sh_type type = (sh_type)below(s, 3);
    const size_t n = some_references(s, references, type, SH_ROLE_INPUT, SH_ROLE_TUNABLE);

    if (type == SH_TYPE_REAL)
        fmi2GetReal(s->instance, references, n, seldom(s, 99) ? NULL : reals);
    else if (type == SH_TYPE_INTEGER)
        fmi2GetInteger(s->instance, references, n, ints);
    else
        fmi2GetBoolean(s->instance, references, n, ints);
    if (seldom(s, 16)) {
        fmi2GetString(s->instance, references, n, strings);
        fmi2SetString(s->instance, references, n, strings);
    }
}

/* All Real variables [size: count of the model, 0 for those of another type]. */
static void get_all(const sequence *s, double *values)
{
    fmi2ValueReference i;

    for (i = 0; i < sh_fmu_model.count; ++i) {
        values[i] = 0.0;
        if (sh_fmu_model.variables[i].type == SH_TYPE_REAL)
            fmi2GetReal(s->instance, &i, 1, &values[i]);
    }
}

static double time_reached(const sequence *s, double otherwise)
{
    fmi2GetRealStatus(s->instance, fmi2LastSuccessfulTime, &otherwise);
    return otherwise;
}

/* A step of at most MAX_TICKS ticks: longer ones are valid, but slow. */
static double short_enough(const sequence *s, double h)
{
    fmi2ValueReference i;
    double T = 0.0;

    for (i = 0; i < sh_fmu_model.count; ++i)
        if (strcmp(sh_fmu_model.variables[i].name, "samplePeriod") == 0 &&
            fmi2GetReal(s->instance, &i, 1, &T) == fmi2OK && h / T > MAX_TICKS && h / T <= 1e9)
            return MAX_TICKS * T;
    return h;
}

static fmi2Status step(const sequence *s, double t, double h)
{
    const double before = time_reached(s, 0.0);
    const fmi2Status status = fmi2DoStep(s->instance, t, h, fmi2True);
    const double after = time_reached(s, 0.0);

    check(status == fmi2OK || status == fmi2Warning || status == fmi2Error,
          "fmi2DoStep gave a status it should not know");
    check(status != fmi2Error || before == after, "a refused step moved the time");
    return status;
}

static void some_step(sequence *s)
{
    static const double SIZES[] = {1e-3, 1e-3, 1e-3, 1e-2, 1e-4, 1.0 / 60.0, 1e-9};
    double h = SIZES[below(s, sizeof SIZES / sizeof SIZES[0])], t = s->time;

    if (seldom(s, 32))
        t = some_real(s, 1.0);
    if (seldom(s, 32))
        h = some_real(s, 1.0);
    step(s, t, short_enough(s, h));
    s->time = time_reached(s, s->time);
}

/* Runs a step, restores, and runs it again. */
static void step_twice(sequence *s)
{
    const double h = short_enough(s, below(s, 2) ? 1e-3 : 1.0 / 60.0);
    double *first = calloc(sh_fmu_model.count, sizeof *first);
    double *second = calloc(sh_fmu_model.count, sizeof *second);
    fmi2FMUstate state = NULL;
    fmi2Status status;

    check(first != NULL && second != NULL, "out of memory");
    if (fmi2GetFMUstate(s->instance, &state) == fmi2OK) {
        status = step(s, s->time, h);
        get_all(s, first);
        check(fmi2SetFMUstate(s->instance, state) == fmi2OK, "a good state was refused");
        check(step(s, s->time, h) == status, "a step repeated gave another status");
        get_all(s, second);
        check(memcmp(first, second, sh_fmu_model.count * sizeof *first) == 0,
              "a step repeated gave another result");
        s->time = time_reached(s, s->time);
        fmi2FreeFMUstate(s->instance, &state);
    }
    free(first);
    free(second);
}

/* Serialises a state, maybe damages it, and reads it back. */
static void serialise(sequence *s, fmi2FMUstate *state)
{
    fmi2FMUstate copy = NULL;
    fmi2Status status;
    fmi2Byte *bytes;
    size_t size = 0, length;
    int damaged = 0;

    if (fmi2SerializedFMUstateSize(s->instance, *state, &size) != fmi2OK)
        return;
    bytes = malloc(size);
    check(bytes != NULL, "out of memory");
    if (seldom(s, 16))
        check(fmi2SerializeFMUstate(s->instance, *state, bytes, size - 1) == fmi2Error,
              "a state went into too little room");
    check(fmi2SerializeFMUstate(s->instance, *state, bytes, size) == fmi2OK,
          "a good state was not serialised");
    length = size;
    if (below(s, 2)) {
        const unsigned flip = byte(s);
        bytes[bits(s) % size] ^= (fmi2Byte)flip;
        damaged = flip != 0;
    }
    if (seldom(s, 4)) { /* truncated, in a block of exactly this size */
        length = (below(s, 2) ? bits(s) : byte(s)) % size;
        bytes = realloc(bytes, length > 0 ? length : 1);
        check(bytes != NULL, "out of memory");
    }
    status = fmi2DeSerializeFMUstate(s->instance, bytes, length, &copy);
    check(status == fmi2Error || (!damaged && length == size), "a spoilt state was taken");
    if (status == fmi2OK) {
        fmi2FreeFMUstate(s->instance, state);
        *state = copy;
    }
    free(bytes);
}

static void use_states(sequence *s)
{
    fmi2FMUstate *state = &s->states[below(s, SLOTS)];

    switch (below(s, 5)) {
    case 0:
    case 1:
        fmi2GetFMUstate(s->instance, state);
        break;
    case 2:
        if (*state != NULL && seldom(s, 32)) {
            unsigned char *place = (unsigned char *)*state + below(s, 100);
            *place ^= 1;
            check(fmi2SetFMUstate(s->instance, *state) == fmi2Error, "a spoilt state was taken");
            *place ^= 1;
        }
        fmi2SetFMUstate(s->instance, *state);
        s->time = time_reached(s, s->time);
        break;
    case 3:
        fmi2FreeFMUstate(s->instance, state);
        break;
    default:
        serialise(s, state);
    }
}

static void ask_for_the_status(sequence *s)
{
    const fmi2StatusKind kind = (fmi2StatusKind)below(s, 4);
    fmi2Status status;
    double real;
    int integer;
    fmi2String string;

    fmi2GetStatus(s->instance, kind, &status);
    fmi2GetRealStatus(s->instance, kind, seldom(s, 9) ? NULL : &real);
    fmi2GetIntegerStatus(s->instance, kind, &integer);
    fmi2GetBooleanStatus(s->instance, kind, seldom(s, 9) ? NULL : &integer);
    fmi2GetStringStatus(s->instance, kind, &string);
}

static void choose_categories(sequence *s)
{
    static const char *const NAMES[] = {"logAll", "logEvents", "logStatusError",
                                        "logStatusWarning"};
    char text[TEXT];
    const fmi2String categories[] = {NAMES[below(s, 4)],
                                     seldom(s, 4) ? some_text(s, text) : NAMES[below(s, 4)]};
    const int on = (int)below(s, 2);
    const size_t n = below(s, 3);

    fmi2SetDebugLogging(s->instance, on, n, seldom(s, 32) ? NULL : categories);
}

static void set_up(sequence *s)
{
    const double start = seldom(s, 4) ? some_real(s, 3.0) : 0.0;
    const int tolerance_defined = (int)below(s, 2), stop_defined = (int)below(s, 2);

    if (fmi2SetupExperiment(s->instance, tolerance_defined, some_real(s, 1e-6), start, stop_defined,
                            some_real(s, 10.0)) == fmi2OK)
        s->time = start;
}

/* Functions that are not provided. */
static void ask_for_derivatives(sequence *s)
{
    const fmi2ValueReference reference = byte(s);
    const fmi2Integer order = 1;
    double value = 0.0;

    fmi2GetRealOutputDerivatives(s->instance, &reference, below(s, 2), &order, &value);
    fmi2GetDirectionalDerivative(s->instance, &reference, 1, &reference, 1, &value, &value);
    fmi2CancelStep(s->instance);
}

static void call(sequence *s)
{
    switch (below(s, 32)) {
    case 0:
        fmi2Reset(s->instance);
        s->time = 0.0;
        break;
    case 1:
        fmi2Terminate(s->instance);
        break;
    case 2:
        choose_categories(s);
        break;
    case 3:
        ask_for_the_status(s);
        break;
    case 4:
        ask_for_derivatives(s);
        break;
    case 5:
        set_up(s);
        break;
    case 6:
        fmi2EnterInitializationMode(s->instance);
        break;
    case 7:
        fmi2ExitInitializationMode(s->instance);
        break;
    case 8: /* all calls up to the first step */
        fmi2Reset(s->instance);
        set_up(s);
        set_real(s, SH_ROLE_GUESS, SH_ROLE_TUNABLE);
        set_int(s);
        fmi2EnterInitializationMode(s->instance);
        fmi2ExitInitializationMode(s->instance);
        break;
    case 9:
    case 10:
        set_real(s, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
        break;
    case 11:
    case 12:
        set_real(s, SH_ROLE_TUNABLE, SH_ROLE_TUNABLE);
        break;
    case 13:
        set_int(s);
        break;
    case 14:
    case 15:
        get(s);
        break;
    case 16:
    case 17:
    case 18:
        use_states(s);
        break;
    case 19:
        step_twice(s);
        break;
    case 20:
    case 21:
    case 22:
        set_derivatives(s);
        break;
    case 23:
    case 24:
    case 25:
    case 26:
        set_real(s, SH_ROLE_INPUT, SH_ROLE_INPUT);
        break;
    default:
        some_step(s);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    sequence s = {data, data + size, NULL, {NULL}, 0.0};
    const unsigned how = byte(&s);
    fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, &allocations_left};
    char text[TEXT];
    int slot;

    allocations_left = seldom(&s, 16) ? (int)below(&s, 16) : INT32_MAX;
    if (how & 1)
        callbacks.logger = logger;
    if (how & 2) {
        callbacks.allocateMemory = allocate;
        callbacks.freeMemory = free;
    }
    if (seldom(&s, 16))
        check(fmi2Instantiate("fuzz", fmi2CoSimulation, some_text(&s, text), NULL, &callbacks,
                              fmi2False, fmi2True) == NULL,
              "a wrong GUID was taken");
    s.instance = fmi2Instantiate(seldom(&s, 4) ? some_text(&s, text) : "fuzz",
                                 seldom(&s, 64) ? fmi2ModelExchange : fmi2CoSimulation,
                                 sh_fmu_model.guid, how & 4 ? "file:///%s" : NULL, &callbacks,
                                 fmi2False, how & 8 ? fmi2True : fmi2False);
    if (!(how & 16)) { /* most sequences begin with an initialised instance */
        fmi2EnterInitializationMode(s.instance);
        fmi2ExitInitializationMode(s.instance);
    }
    while (s.next < s.end)
        call(&s);
    for (slot = 0; slot < SLOTS; ++slot)
        fmi2FreeFMUstate(s.instance, &s.states[slot]);
    fmi2FreeInstance(s.instance);
    return 0;
}
