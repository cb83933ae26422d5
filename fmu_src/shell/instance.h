/* One instance of the FMU, the same in every version of FMI. */
#ifndef SH_INSTANCE_H
#define SH_INSTANCE_H

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

/* What the importer gave to the instance. Any of it may be NULL. */
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
    int outputs_stale;        /* in initialisation: outputs are older than the values set */
    int parameters_unchecked; /* a parameter was set since the last check */
    size_t slopes_end; /* number of first variables in which a derivative may differ from 0 */
    void *model;       /* of sh_fmu_model.size bytes */
};

#endif
