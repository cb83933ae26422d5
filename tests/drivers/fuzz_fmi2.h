/* What only FMI 2.0 has: memory from the importer, derivatives of inputs. */

static int allocations_left; /* until the allocator of the importer fails */

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
    if (seldom(s, 16)) {
        check(fmi2Instantiate("fuzz", fmi2CoSimulation, some_text(s, text), NULL, &callbacks,
                              fmi2False, fmi2True) == NULL,
              "a wrong GUID was taken");
    }
    return fmi2Instantiate(seldom(s, 4) ? some_text(s, text) : "fuzz",
                           seldom(s, 64) ? fmi2ModelExchange : fmi2CoSimulation, sh_fmu_model.guid,
                           how & 4 ? "file:///%s" : NULL, &callbacks, fmi2False,
                           how & 8 ? fmi2True : fmi2False);
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

/* In FMI 2.0 a call of its own, and an importer may leave it out. */
static void set_up(sequence *s)
{
    const double start = some_real(s, 3.0), stop_time = start + some_real(s, 10.0);
    const int stop_time_defined = (int)below(s, 2);

    if (fmi2SetupExperiment(s->instance, fmi2False, 0.0, start, stop_time_defined, stop_time) ==
        fmi2OK) {
        s->time = start;
        s->stop_time = stop_time_defined ? stop_time : INFINITY;
    }
    if (below(s, 2)) {
        fmi2EnterInitializationMode(s->instance);
    }
}

static void call_of_this_version(sequence *s)
{
    (below(s, 4) == 0 ? set_up : set_derivatives)(s);
}
