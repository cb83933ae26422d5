/* An instance of the FMU, and access to the values of its variables.
 *
 * The shell is the same for every version of FMI. The functions of FMI in fmi2/ and fmi3/ only translate arguments and
 * status for creation.h, simulation.h, access.h and saved_state.h. A call first passes guards.h, which refuses a wrong
 * call with a message of log.h. The argument `function` of a function of the shell is the name of the function of FMI,
 * with which all messages begin.
 */
#ifndef SH_INSTANCE_H
#define SH_INSTANCE_H

#include <limits.h>

#include "model.h"

/* State of an instance in the state machine of FMI. Each state is one bit, so that a function can name all states in
 * which it may be called.
 */
typedef enum {
    SH_INSTANTIATED = 1,
    SH_INITIALIZATION = 2,
    SH_STEP = 4, /* between communication steps */
    SH_TERMINATED = 8,
    SH_ANY = 15
} sh_state;

/* Pointers that the importer passes when it creates an instance. Each pointer of the importer may be NULL. */
typedef struct {
    void *environment;
    void (*logger)(void); /* logger of the importer; sh_deliver casts it to its real type */
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
} sh_importer;

struct sh_instance {
    sh_importer importer;
    char *name;
    unsigned categories; /* bit set SH_LOG_*: categories of messages that are logged */
    sh_state state;
    double time;              /* current communication point [s] */
    double stop_time;         /* no step may end after this time; infinite without a stop time */
    double steps;             /* number of communication steps so far */
    double previous_step;     /* length of the last step [s]; 0 before the first step */
    int outputs_stale;        /* 1: a value was set after the outputs were computed */
    int parameters_unchecked; /* 1: a parameter was set after the last check */
    size_t slopes_end;        /* no variable from this index on has an input derivative; 0: the
                                 inputs are held */
    int warned;               /* 1 after sh_warn_once */
    void *model;              /* struct of the model, with sh_fmu_model.size bytes */
};

static inline int sh_is_parameter(const sh_variable *variable)
{
    return variable->role == SH_ROLE_FIXED || variable->role == SH_ROLE_TUNABLE;
}

static inline void *sh_place(const sh_instance *instance, const sh_variable *variable)
{
    return (char *)instance->model + variable->offset;
}

/* Returns the value of a variable of any type as a double, which can represent every int. */
static inline double sh_read(const sh_instance *instance, const sh_variable *variable)
{
    const void *place = sh_place(instance, variable);

    return variable->type == SH_TYPE_REAL ? *(const double *)place : (double)*(const int *)place;
}

static inline void sh_write(sh_instance *instance, const sh_variable *variable, double value)
{
    void *place = sh_place(instance, variable);

    if (variable->type == SH_TYPE_REAL) {
        *(double *)place = value;
    } else {
        /* A value outside of int is only possible if the importer changed its array after the check. */
        *(int *)place = value >= INT_MAX ? INT_MAX : value > INT_MIN ? (int)value : INT_MIN;
    }
}

/* Returns the address of the time derivative of a Real input. */
static inline double *sh_slope(sh_instance *instance, const sh_variable *input)
{
    return (double *)(void *)((char *)sh_place(instance, input) + sh_fmu_model.derivative_offset);
}

#endif
