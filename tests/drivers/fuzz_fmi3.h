/* What only FMI 3.0 has: integers of any size, and numbers of values. */

static int environment; /* that of the importer */

static void logger(fmi3InstanceEnvironment received, fmi3Status status, fmi3String category,
                   fmi3String message)
{
    check(received == &environment, "the logger got another environment");
    check_message((int)status, category, message);
}

static void *instance_of(sequence *s, const char *name, const char *token)
{
    const unsigned how = byte(s);

    return fmi3InstantiateCoSimulation(name, token, how & 1 ? "/%s" : NULL, (how & 2) != 0,
                                       (how & 4) != 0, fmi3False, (how & 8) != 0, NULL, 0,
                                       &environment, how & 16 ? NULL : logger, NULL);
}

static void *some_instance(sequence *s)
{
    char text[TEXT];

    if (seldom(s, 16)) {
        check(instance_of(s, "fuzz", some_text(s, text)) == NULL, "a wrong token was taken");
    }
    return instance_of(s, seldom(s, 4) ? some_text(s, text) : "fuzz", sh_fmu_model.guid);
}

/* 1 to 3, or what a conversion to int changes. */
static fmi3Int64 some_int64(sequence *s)
{
    static const fmi3Int64 ODD[] = {INT64_MAX, INT64_MIN, INT64_C(1) + INT32_MAX, -1,
                                    (INT64_C(1) << 32) + 1};

    return seldom(s, 8) ? ODD[below(s, 5)] : some_integer(s);
}

static void use_integers(sequence *s, int sets)
{
    uint32_t references[MAX_REFERENCES];
    fmi3Int64 int64s[MAX_REFERENCES];
    fmi3Int32 int32s[MAX_REFERENCES];
    fmi3Boolean booleans[MAX_REFERENCES];
    const unsigned type = 1u << (1 + below(s, 3)); /* of SH_TYPE_* */
    const sh_role first =
        type == SH_TYPE_ENUMERATION && !seldom(s, 16) ? SH_ROLE_FIXED : SH_ROLE_INPUT;
    const size_t n = some_references(s, references, type, first, SH_ROLE_TUNABLE);
    size_t i;

    for (i = 0; i < n; ++i) {
        int64s[i] = some_int64(s);
        int32s[i] = some_integer(s);
        booleans[i] = int32s[i] > 1;
    }
    if (type == SH_TYPE_BOOLEAN) {
        sets ? fmi3SetBoolean(s->instance, references, n, booleans, n)
             : fmi3GetBoolean(s->instance, references, n, booleans, n);
    } else if (type == SH_TYPE_INTEGER) {
        sets ? fmi3SetInt32(s->instance, references, n, int32s, n)
             : fmi3GetInt32(s->instance, references, n, int32s, n);
    } else if (!sets) {
        fmi3GetInt64(s->instance, references, n, int64s, n);
    } else if (fmi3SetInt64(s->instance, references, n, int64s, n) == fmi3OK) {
        for (i = 0; i < n; ++i) {
            check(int64s[i] >= 1 && (double)int64s[i] <= sh_fmu_model.variables[references[i]].max,
                  "an enumeration was set to a value that it has not");
        }
    }
}

/* Reads and writes Real variables with any references and any number of values. Only the right number
 * may be taken, and a refused call reads nothing.
 */
static void call_of_this_version(sequence *s)
{
    uint32_t references[MAX_REFERENCES];
    const size_t n = some_references(s, references, SH_TYPE_REAL, SH_ROLE_INPUT, SH_ROLE_TUNABLE);
    const size_t given = below(s, 2) ? n : below(s, 8);
    double *values = memory(given * sizeof *values), *before = memory(given * sizeof *before);
    size_t i;

    if (n > 0 && below(s, 2)) {
        references[0] = (uint32_t)((byte(s) << 8 | byte(s)) % (sh_fmu_model.count + 2));
    }
    for (i = 0; i < given; ++i) {
        before[i] = values[i] = some_real(s, 1.0);
    }
    if (below(s, 2)) {
        check(fmi3SetFloat64(s->instance, references, n, values, given) != fmi3OK || given == n,
              "values of the wrong number were set");
    } else if (fmi3GetFloat64(s->instance, references, n, values, given) == fmi3OK) {
        check(given == n, "values of the wrong number were read");
    } else {
        check(memcmp(values, before, given * sizeof *values) == 0, "a refused call read values");
    }
    free(values);
    free(before);
}
