/* One instance of the FMU and the values of its variables, the same in every version of FMI. */
#ifndef SH_INSTANCE_H
#define SH_INSTANCE_H

#include <limits.h>

#include "model.h"

/* State of the instance in the state machine of FMI. The values are bits, so that each function can
 * name the set of its allowed states.
 */
typedef enum {
    SH_INSTANTIATED = 1,
    SH_INITIALIZATION = 2,
    SH_STEP = 4, /* between communication steps */
    SH_TERMINATED = 8,
    SH_ANY = 15
} sh_state;

/* Arguments of the importer for the instance. Any of it may be NULL. */
typedef struct {
    void *environment;
    void (*logger)(void); /* function for messages; sh_deliver knows the type */
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
} sh_importer;

struct sh_instance {
    sh_importer importer;
    char *name;
    unsigned categories; /* SH_LOG_* that are passed on */
    sh_state state;
    double time;              /* communication point reached */
    double stop_time;         /* no step may end after this time; infinite: no stop time */
    double steps;             /* communication steps made */
    double previous_step;     /* length of the last step [s]; 0: no step yet */
    int outputs_stale;        /* 1 if outputs are older than the values set in initialisation */
    int parameters_unchecked; /* a parameter was set since the last check */
    size_t slopes_end; /* number of first variables in which a derivative may differ from 0 */
    void *model;       /* of sh_fmu_model.size bytes */
};

static inline int sh_is_parameter(const sh_variable *variable)
{
    return variable->role == SH_ROLE_FIXED || variable->role == SH_ROLE_TUNABLE;
}

/* 1 if the variable may have this value; else 0, after a message. Only parameters have limits: an
 * input that is not finite skips ticks.
 */
int sh_accepts(sh_instance *instance, const sh_variable *variable, double value,
               const char *function);

static inline void *sh_place(const sh_instance *instance, const sh_variable *variable)
{
    return (char *)instance->model + variable->offset;
}

/* The value of a variable of any type: a double holds every int. */
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
        /* The value is in its range, unless the importer changed it after the check. */
        *(int *)place = value >= INT_MAX ? INT_MAX : value > INT_MIN ? (int)value : INT_MIN;
    }
}

/* Time derivative of a Real input. */
static inline double *sh_slope(sh_instance *instance, const sh_variable *input)
{
    return (double *)(void *)((char *)sh_place(instance, input) + sh_fmu_model.derivative_offset);
}

#endif
