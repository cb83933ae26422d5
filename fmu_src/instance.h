/* One instance of the FMU: shared by the files of the FMI shell. */
#ifndef SH_INSTANCE_H
#define SH_INSTANCE_H

#include "fmi2Functions.h"
#include "model.h"

/* Where the instance stands in the state machine of FMI 2.0, section 4.2.4. Bits,
 * so that each function can name the set of states it is allowed in.
 */
typedef enum {
    SH_INSTANTIATED = 1,
    SH_INITIALIZATION = 2,
    SH_STEP = 4, /* stepComplete */
    SH_TERMINATED = 8,
    SH_ANY = 15
} sh_state;

enum {
    SH_LOG_EVENTS = 1,
    SH_LOG_WARNING = 2,
    SH_LOG_DISCARD = 4,
    SH_LOG_ERROR = 8,
    SH_LOG_STATUS = 14, /* all but events */
    SH_LOG_ALL = 15
};

struct sh_instance {
    fmi2CallbackFunctions callbacks; /* of the importer; any of them may be NULL */
    char *name;
    unsigned categories; /* SH_LOG_* that are passed on */
    sh_state state;
    double time;              /* communication point reached */
    int outputs_stale;        /* in initialisation: outputs are older than what was set */
    int parameters_unchecked; /* a parameter was set since they were checked */
    int slopes_set;           /* derivatives of inputs may differ from 0 */
    void *model;              /* of sh_fmu_model.size bytes */
};

/* The instance behind c if it is in one of the allowed states; else NULL, after
 * a message that names the function.
 */
sh_instance *sh_enter(fmi2Component c, unsigned allowed_states, const char *function);

/* 1 if the pointer is not NULL; else 0, after a message. */
int sh_has(sh_instance *instance, const void *pointer, const char *function, const char *argument);

/* Memory from the functions of the importer, or from the C library if it has none. Zero. */
void *sh_allocate(const fmi2CallbackFunctions *callbacks, size_t size);
void sh_release(const fmi2CallbackFunctions *callbacks, void *memory);

/* Replaces every byte that is not part of UTF-8 by '?'; returns 1 if there was one. */
int sh_make_utf8(char *text);

/* Sets every variable to its start value. */
void sh_set_start_values(sh_instance *instance);

/* Checks the parameters, if one was set since the last check. */
fmi2Status sh_check_parameters(sh_instance *instance);

/* Checks the parameters and computes the initial outputs, if anything was set since the last time.
 */
fmi2Status sh_initialize(sh_instance *instance);

#endif
