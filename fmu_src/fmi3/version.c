/* FMI 3.0 as a version of FMI: its name, its logger, and how it names types. */
#include "version.h"

#include "fmi3Functions.h"

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

/* In a message, #7# means the value of variable 7, so sh_report doubles each # in a message. */
const char sh_special = '#';

void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text)
{
    const fmi3LogMessageCallback logger = (fmi3LogMessageCallback)instance->importer.logger;

    logger(instance->importer.environment, (fmi3Status)status, category, text);
}

const char *sh_type_name(sh_type type)
{
    switch (type) {
    case SH_TYPE_REAL:
        return "Float64";
    case SH_TYPE_INTEGER:
        return "Int32";
    case SH_TYPE_ENUMERATION:
        return "an Enumeration (Int64)";
    default:
        return "Boolean";
    }
}
