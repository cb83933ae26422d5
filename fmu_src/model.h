/* Interface between a model and the FMI shell (shell/, fmi2/, fmi3/). A model defines one constant of type sh_model.
 *
 * A model is one plain struct without pointers that holds parameters, inputs, outputs and state. The shell allocates
 * this struct and accesses its variables through a table generated from the model description. To save and restore
 * the state of the FMU, the shell copies the whole struct.
 */
#ifndef SH_MODEL_H
#define SH_MODEL_H

#include <stddef.h>

/* Result of a call. Every version of FMI uses the same numbers for the status of a call. */
typedef enum { SH_OK, SH_WARNING, SH_DISCARD, SH_ERROR } sh_status;

/* Type of a variable. Each type of variable is one bit, so that a function can accept a set of types. */
typedef enum {
    SH_TYPE_REAL = 1,
    SH_TYPE_INTEGER = 2,
    SH_TYPE_ENUMERATION = 4,
    SH_TYPE_BOOLEAN = 8
} sh_type;

typedef enum {
    SH_ROLE_INPUT,
    SH_ROLE_OUTPUT,
    SH_ROLE_GUESS,  /* output with a start value, which the model overwrites */
    SH_ROLE_FIXED,  /* parameter, settable until the end of initialisation */
    SH_ROLE_TUNABLE /* parameter, also settable between steps */
} sh_role;

/* A variable of the FMU. The value reference of a variable is its index in the table of variables. */
typedef struct {
    const char *name;
    size_t offset; /* offset in the model's struct of a double (Real) or an int */
    sh_type type;
    sh_role role;
    double start;
    double min, max; /* smallest and largest allowed value; infinite without a limit */
} sh_variable;

/* Sends a message to the user through the logger of the importer, with a format as in printf. */
typedef struct sh_instance sh_instance;
void sh_report(sh_instance *instance, sh_status status, const char *format, ...);

/* Sends a warning as sh_report does, but only the first one of an instance, until the instance is reset. A state from
 * before the warning, which an importer restores, does not bring the warning back.
 */
void sh_warn_once(sh_instance *instance, const char *format, ...);

typedef struct {
    const char *identifier; /* modelIdentifier */
    const char *guid;       /* GUID of FMI 2.0 and instantiation token of FMI 3.0 */
    size_t size;            /* of the model's struct */
    const sh_variable *variables;
    size_t count;
    /* If an input has the offset o, its time derivative has the offset o + derivative_offset. */
    size_t derivative_offset;
    /* Checks constraints between parameters, after the shell has checked the range of each parameter. Returns SH_OK,
     * or SH_ERROR after a message. A model without constraints sets `check` to NULL.
     */
    sh_status (*check)(const void *model, sh_instance *log);
    /* Called after the importer has set the parameter at an offset in the model's struct, so that start values can
     * follow it. A model without such start values sets `follow` to NULL.
     */
    void (*follow)(void *model, size_t offset);
    /* Computes state and outputs at time t [s] from parameters and inputs. `initialize` may be called repeatedly. */
    void (*initialize)(void *model, double t);
    /* Returns 1 if an initialised model can advance from the state in `model`. The shell calls `is_state` for a
     * deserialised state, after it has checked the range of each parameter.
     */
    int (*is_state)(const void *model);
    /* Advances the model from t to t + h, where h > 0. At a time s in [t, t + h] an input is u + du/dt (s - t).
     * `held` is 1 if the importer has set no du/dt for this step. Returns SH_OK, or SH_WARNING or SH_ERROR after a message.
     */
    sh_status (*step)(void *model, double t, double h, int held, sh_instance *log);
} sh_model;

extern const sh_model sh_fmu_model;

/* Defines sh_fmu_model from variables.h and from the functions initialize, is_state and step of the including file. */
#define SH_DEFINE_MODEL(Struct, offset_of_derivatives, check_or_null, follow_or_null)              \
    const sh_model sh_fmu_model = {                                                                \
        .identifier = SH_IDENTIFIER,                                                               \
        .guid = SH_GUID,                                                                           \
        .size = sizeof(Struct),                                                                    \
        .variables = VARIABLES,                                                                    \
        .count = sizeof VARIABLES / sizeof VARIABLES[0],                                           \
        .derivative_offset = (offset_of_derivatives),                                              \
        .check = (check_or_null),                                                                  \
        .follow = (follow_or_null),                                                                \
        .initialize = initialize,                                                                  \
        .is_state = is_state,                                                                      \
        .step = step,                                                                              \
    }

#endif
