#include "creation.h"

#include <math.h>
#include <string.h>

#include "guards.h"
#include "log.h"
#include "allocation.h"

/* Returns a temporary instance that can log messages before the real instance exists. */
static sh_instance nobody(const sh_importer *importer)
{
    static char nameless[] = "(no name)";
    sh_instance instance = {0};

    instance.importer = *importer;
    instance.name = nameless;
    instance.categories = SH_LOG_ALL;
    return instance;
}

void *sh_refuse_instance(const sh_importer *importer, const char *function, const char *wanted)
{
    sh_instance before = nobody(importer);

    sh_report(&before, SH_ERROR, "%s: %s is an FMU for co-simulation, not for %s.", function,
              sh_fmu_model.identifier, wanted);
    return NULL;
}

/* FMI asks for a name with at least one character that is not white space. */
static int is_empty(const char *name)
{
    while (*name == ' ' || *name == '\t' || *name == '\r' || *name == '\n') {
        ++name;
    }
    return *name == '\0';
}

static void set_start_values(sh_instance *instance)
{
    size_t i;

    (void)memset(instance->model, 0, sh_fmu_model.size);
    for (i = 0; i < sh_fmu_model.count; ++i) {
        sh_write(instance, &sh_fmu_model.variables[i], sh_fmu_model.variables[i].start);
    }
    instance->state = SH_INSTANTIATED;
    instance->time = 0.0;
    instance->stop_time = INFINITY;
    instance->steps = 0.0;
    instance->previous_step = 0.0;
    instance->outputs_stale = 1;
    instance->parameters_unchecked = 1;
    instance->slopes_end = 0;
    instance->warned = 0;
}

sh_instance *sh_create(const sh_importer *importer, const char *name, const char *guid,
                       unsigned categories, const char *function)
{
    sh_instance before = nobody(importer);
    sh_instance *instance;
    void *model;
    char *own_name;

    if (!sh_has(&before, name, function, "instanceName")) {
        return NULL;
    }
    if (is_empty(name)) {
        sh_report(&before, SH_ERROR, "%s: argument instanceName is empty.", function);
        return NULL;
    }
    if (guid == NULL || strcmp(guid, sh_fmu_model.guid) != 0) {
        sh_report(
            &before, SH_ERROR,
            "%s: the binary of %s expects the GUID or instantiation token %s, the importer gave "
            "%s: modelDescription.xml and binary are not of the same FMU.",
            function, sh_fmu_model.identifier, sh_fmu_model.guid, guid != NULL ? guid : "NULL");
        return NULL;
    }

    instance = sh_allocate(importer, sizeof *instance);
    model = sh_allocate(importer, sh_fmu_model.size);
    own_name = sh_allocate(importer, strlen(name) + 1);
    if (instance == NULL || model == NULL || own_name == NULL) {
        sh_release(importer, instance);
        sh_release(importer, model);
        sh_release(importer, own_name);
        sh_report(&before, SH_ERROR, "%s: out of memory.", function);
        return NULL;
    }
    instance->importer = *importer;
    instance->model = model;
    instance->name = strcpy(own_name, name);
    instance->categories = categories;
    set_start_values(instance);
    return instance;
}

void sh_destroy(sh_instance *instance)
{
    sh_importer importer;

    if (instance == NULL) {
        return;
    }
    importer = instance->importer;
    sh_release(&importer, instance->model);
    sh_release(&importer, instance->name);
    sh_release(&importer, instance);
}

sh_status sh_reset(void *handle, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);

    if (instance == NULL) {
        return SH_ERROR;
    }
    set_start_values(instance);
    return SH_OK;
}
