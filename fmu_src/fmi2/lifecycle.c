/* FMI 2.0: inquiry, logging, creation and the course of a simulation. */
#include "fmi2Functions.h"
#include "log.h"
#include "simulation.h"

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text)
{
    const fmi2CallbackLogger logger = (fmi2CallbackLogger)instance->importer.logger;
    char escaped[1024];

    /* The logger uses the message as a format: a % must not start a conversion. */
    sh_double(escaped, sizeof escaped, text, '%');
    logger(instance->importer.environment, instance->name, (fmi2Status)status, category, escaped);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2SetDebugLogging");
    unsigned found = 0;
    sh_status status;

    if (instance == NULL ||
        (nCategories > 0 && !sh_has(instance, categories, "fmi2SetDebugLogging", "categories"))) {
        return fmi2Error;
    }
    status = sh_find_categories(instance, nCategories, categories, &found, "fmi2SetDebugLogging");
    if (!loggingOn) {
        instance->categories = SH_LOG_STATUS; /* all but debug messages */
    } else if (found != 0) {
        instance->categories = found;
    }
    return (fmi2Status)status;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    sh_importer importer;

    (void)fmuResourceLocation; /* the FMU has no resources */
    (void)visible;
    if (functions == NULL) {
        return NULL;
    }
    importer.environment = functions->componentEnvironment;
    importer.logger = (void (*)(void))functions->logger;
    importer.allocate = functions->allocateMemory;
    importer.release = functions->freeMemory;
    if (fmuType != fmi2CoSimulation) {
        return sh_refuse_instance(&importer, "fmi2Instantiate", "model exchange");
    }
    return sh_create(&importer, instanceName, fmuGUID, loggingOn ? SH_LOG_ALL : SH_LOG_STATUS,
                     "fmi2Instantiate");
}

void fmi2FreeInstance(fmi2Component c)
{
    sh_destroy(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    const sh_experiment experiment = {toleranceDefined, tolerance, startTime, stopTimeDefined,
                                      stopTime};
    sh_instance *instance = sh_enter(c, SH_INSTANTIATED, "fmi2SetupExperiment");

    if (instance == NULL) {
        return fmi2Error;
    }
    return (fmi2Status)sh_set_up(instance, &experiment, "fmi2SetupExperiment");
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return (fmi2Status)sh_begin_initialization(c, "fmi2EnterInitializationMode");
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return (fmi2Status)sh_end_initialization(c, "fmi2ExitInitializationMode");
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return (fmi2Status)sh_terminate(c, "fmi2Terminate");
}

fmi2Status fmi2Reset(fmi2Component c)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2Reset");

    if (instance == NULL) {
        return fmi2Error;
    }
    sh_reset(instance);
    return fmi2OK;
}
