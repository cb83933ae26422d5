/* One instance of the FMU, and what can be done with it, the same in every version of FMI.
 *
 * The functions of an importer (fmi2/, fmi3/) translate arguments and status; the rest is here. Each
 * function here that takes the name of the importer's function begins its messages with it.
 */
#ifndef SH_INSTANCE_H
#define SH_INSTANCE_H

#include <stddef.h>

#include "model.h"

/* Where the instance stands in the state machine of FMI. Bits, so that each function can name the
 * set of states it is allowed in.
 */
typedef enum {
    SH_INSTANTIATED = 1,
    SH_INITIALIZATION = 2,
    SH_STEP = 4, /* between communication steps */
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

/* What the importer gave to the instance. Any of it may be NULL. */
typedef struct {
    void *environment;
    void (*logger)(void); /* its function for messages; sh_deliver knows the type */
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
} sh_importer;

struct sh_instance {
    sh_importer importer;
    char *name;
    unsigned categories; /* SH_LOG_* that are passed on */
    sh_state state;
    double time;              /* communication point reached */
    double stop_time;         /* no step may end after it; infinite if there is none */
    double steps;             /* communication steps made */
    double previous_step;     /* length of the last one [s]; 0: there is none */
    int outputs_stale;        /* in initialisation: outputs are older than what was set */
    int parameters_unchecked; /* a parameter was set since they were checked */
    int slopes_set;           /* derivatives of inputs may differ from 0 */
    void *model;              /* of sh_fmu_model.size bytes */
};

/* Gives a message to the importer's logger, which is not NULL. Each version of FMI has its own. */
void sh_deliver(const sh_instance *instance, sh_status status, const char *category,
                const char *text);

/* Writes the SH_LOG_* of some categories to *found, SH_LOG_ALL if count is 0. Unknown ones are ignored,
 * with a warning.
 */
sh_status sh_find_categories(sh_instance *instance, size_t count, const char *const categories[],
                             unsigned *found, const char *function);

/* Copies text, with every `special` character twice; at most size - 1 characters. */
void sh_double(char *copy, size_t size, const char *text, char special);

/* A new instance that passes on some categories of messages, or NULL after a message. */
sh_instance *sh_create(const sh_importer *importer, const char *name, const char *guid,
                       unsigned categories, const char *function);
/* NULL, after a message that the FMU is not for what is wanted. */
void *sh_refuse_instance(const sh_importer *importer, const char *function, const char *wanted);
void sh_destroy(sh_instance *instance);

/* Back to the state after sh_create, with all start values. The categories of messages stay. */
void sh_reset(sh_instance *instance);

/* The instance behind the importer's handle if it is in one of the allowed states; else NULL, after a
 * message.
 */
sh_instance *sh_enter(void *handle, unsigned allowed_states, const char *function);

/* 1 if the pointer is not NULL; else 0, after a message. */
int sh_has(sh_instance *instance, const void *pointer, const char *function, const char *argument);

/* Memory from the functions of the importer, or from the C library if it has none. Zero. */
void *sh_allocate(const sh_importer *importer, size_t size);
void sh_release(const sh_importer *importer, void *memory);

/* Replaces every byte that is not part of UTF-8 by '?'; returns 1 if there was one. */
int sh_make_utf8(char *text);

/* The experiment that the importer announces, and its start: times in s. */
typedef struct {
    int tolerance_defined;
    double tolerance;
    double start_time;
    int stop_time_defined;
    double stop_time;
} sh_experiment;

/* Refuses what is not finite or in the wrong order. Nothing has a tolerance to be set. */
sh_status sh_set_up(sh_instance *instance, const sh_experiment *experiment, const char *function);

/* The course of a simulation. `handle` is what the importer gave; it may be NULL. */
sh_status sh_begin_initialization(void *handle, const char *function);
sh_status sh_end_initialization(void *handle, const char *function);
sh_status sh_communication_step(void *handle, double t, double h, const char *function);
sh_status sh_terminate(void *handle, const char *function);

/* Checks the range of each parameter. */
sh_status sh_check_ranges(sh_instance *instance, const char *function);

/* Checks the parameters, if one was set since the last check. */
sh_status sh_check_parameters(sh_instance *instance);

/* Checks the parameters and computes the initial outputs, if anything was set since the last time.
 */
sh_status sh_initialize(sh_instance *instance);

#endif
