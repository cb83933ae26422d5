/* FMI 2.0 as a version of FMI: its name, its logger, and how it names types. */
#include "version.h"

#include "fmi2Functions.h"

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* The logger takes a message as a printf format, so sh_report doubles each % in a message. */
const char sh_special = '%';

void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text)
{
    const fmi2CallbackLogger logger = (fmi2CallbackLogger)instance->importer.logger;

    logger(instance->importer.environment, instance->name, (fmi2Status)status, category, text);
}

const char *sh_type_name(sh_type type)
{
    switch (type) {
    case SH_TYPE_REAL:
        return "Real";
    case SH_TYPE_BOOLEAN:
        return "Boolean";
    default:
        return "Integer or Enumeration";
    }
}
