/* FMI 2.0: inquiry, logging, creation and the course of a simulation. */
#include <math.h>
#include <string.h>

#include "instance.h"

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    static const struct {
        const char *name;
        unsigned category;
    } KNOWN[] = {{"logEvents", SH_LOG_EVENTS},
                 {"logStatusWarning", SH_LOG_WARNING},
                 {"logStatusDiscard", SH_LOG_DISCARD},
                 {"logStatusError", SH_LOG_ERROR},
                 {"logAll", SH_LOG_ALL}};
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2SetDebugLogging");
    unsigned chosen = 0;
    size_t i, k;

    if (instance == NULL ||
        (nCategories > 0 && !sh_has(instance, categories, "fmi2SetDebugLogging", "categories")))
        return fmi2Error;
    for (i = 0; i < nCategories; ++i) {
        unsigned category = 0;
        for (k = 0; k < sizeof KNOWN / sizeof KNOWN[0]; ++k)
            if (categories[i] != NULL && strcmp(categories[i], KNOWN[k].name) == 0)
                category = KNOWN[k].category;
        if (category == 0) {
            sh_log(instance, fmi2Error,
                   "fmi2SetDebugLogging: unknown category %s; known are logEvents, "
                   "logStatusWarning, logStatusDiscard, logStatusError and logAll.",
                   categories[i] != NULL ? categories[i] : "NULL");
            return fmi2Error;
        }
        chosen |= category;
    }
    if (!loggingOn)
        instance->categories = SH_LOG_STATUS; /* all but debug messages */
    else
        instance->categories = nCategories > 0 ? chosen : SH_LOG_ALL;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    static char nameless[] = "(no name)";
    sh_instance before = {0}; /* for messages while there is no instance */
    sh_instance *instance;

    (void)fmuResourceLocation; /* the FMU has no resources */
    (void)visible;
    if (functions == NULL)
        return NULL;
    before.callbacks = *functions;
    before.name = nameless;
    before.categories = SH_LOG_ALL;
    if (instanceName == NULL) {
        sh_log(&before, fmi2Error, "fmi2Instantiate: argument instanceName is NULL.");
        return NULL;
    }
    if (fmuType != fmi2CoSimulation) {
        sh_log(&before, fmi2Error,
               "fmi2Instantiate: %s is an FMU for co-simulation, not for model exchange.",
               sh_fmu_model.identifier);
        return NULL;
    }
    if (fmuGUID == NULL || strcmp(fmuGUID, sh_fmu_model.guid) != 0) {
        sh_log(&before, fmi2Error,
               "fmi2Instantiate: the binary of %s expects the GUID %s, the importer gave %s: "
               "modelDescription.xml and binary are not of the same FMU.",
               sh_fmu_model.identifier, sh_fmu_model.guid, fmuGUID != NULL ? fmuGUID : "NULL");
        return NULL;
    }

    instance = sh_allocate(functions, sizeof *instance);
    if (instance != NULL) {
        instance->model = sh_allocate(functions, sh_fmu_model.size);
        instance->name = sh_allocate(functions, strlen(instanceName) + 1);
    }
    if (instance == NULL || instance->model == NULL || instance->name == NULL) {
        sh_log(&before, fmi2Error, "fmi2Instantiate: out of memory.");
        if (instance != NULL) {
            sh_release(functions, instance->model);
            sh_release(functions, instance->name);
        }
        sh_release(functions, instance);
        return NULL;
    }
    strcpy(instance->name, instanceName);
    instance->callbacks = *functions;
    instance->categories = loggingOn ? SH_LOG_ALL : SH_LOG_STATUS;
    instance->state = SH_INSTANTIATED;
    sh_set_start_values(instance);
    if (sh_make_utf8(instance->name))
        sh_log(instance, fmi2Warning,
               "fmi2Instantiate: instanceName is not UTF-8; messages name %s.", instance->name);
    return instance;
}

void fmi2FreeInstance(fmi2Component c)
{
    sh_instance *instance = c;
    fmi2CallbackFunctions callbacks;

    if (instance == NULL)
        return;
    callbacks = instance->callbacks;
    sh_release(&callbacks, instance->model);
    sh_release(&callbacks, instance->name);
    sh_release(&callbacks, instance);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    sh_instance *instance = sh_enter(c, SH_INSTANTIATED, "fmi2SetupExperiment");

    (void)toleranceDefined;
    (void)tolerance;
    if (instance == NULL)
        return fmi2Error;
    if (!isfinite(startTime)) {
        sh_log(instance, fmi2Error, "fmi2SetupExperiment: startTime = %g is not finite.",
               startTime);
        return fmi2Error;
    }
    /* Steps beyond stopTime are allowed: importers round the length of their last step. */
    if (stopTimeDefined && !(stopTime >= startTime)) {
        sh_log(instance, fmi2Error,
               "fmi2SetupExperiment: stopTime = %.9g is before startTime = %.9g.", stopTime,
               startTime);
        return fmi2Error;
    }
    instance->time = startTime;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_INSTANTIATED, "fmi2EnterInitializationMode");

    if (instance == NULL)
        return fmi2Error;
    instance->state = SH_INITIALIZATION;
    instance->outputs_stale = 1;
    return fmi2OK;
}

/* After an error of a parameter the instance stays in initialisation mode, where it can be
 * corrected.
 */
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_INITIALIZATION, "fmi2ExitInitializationMode");

    if (instance == NULL || sh_initialize(instance) != fmi2OK)
        return fmi2Error;
    instance->state = SH_STEP;
    sh_log(instance, fmi2OK, "Initialised at t = %.9g s.", instance->time);
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_STEP, "fmi2Terminate");

    if (instance == NULL)
        return fmi2Error;
    instance->state = SH_TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2Reset");

    if (instance == NULL)
        return fmi2Error;
    instance->state = SH_INSTANTIATED;
    instance->time = 0.0;
    sh_set_start_values(instance);
    return fmi2OK;
}
