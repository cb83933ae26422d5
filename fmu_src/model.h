/* A model provides one constant of type sh_model for the FMI shell (shell/, fmi2/, fmi3/).
 *
 * A model is one plain struct without pointers that holds parameters, inputs,
 * outputs and state. The shell allocates this struct, and accesses its variables through the table generated from the
 * model description. To save and restore the state of the FMU, the shell copies the whole struct.
 */
#ifndef SH_MODEL_H
#define SH_MODEL_H

#include <stddef.h>

/* Result of a call. The values are those of FMI, in any of its versions. */
typedef enum { SH_OK, SH_WARNING, SH_DISCARD, SH_ERROR } sh_status;

/* Bits, so that a function can name the types that it is for. */
typedef enum {
    SH_TYPE_REAL = 1,
    SH_TYPE_INTEGER = 2,
    SH_TYPE_ENUMERATION = 4,
    SH_TYPE_BOOLEAN = 8
} sh_type;

typedef enum {
    SH_ROLE_INPUT,
    SH_ROLE_OUTPUT,
    SH_ROLE_GUESS,  /* output with a start value; the model overwrites it */
    SH_ROLE_FIXED,  /* parameter, settable until the end of initialisation */
    SH_ROLE_TUNABLE /* parameter, also settable between steps */
} sh_role;

/* One variable. The value reference of a variable is its index in the table. */
typedef struct {
    const char *name;
    size_t offset; /* place of a double (Real) or an int in the model's struct */
    sh_type type;
    sh_role role;
    double start;
    double min, max; /* allowed values, including both limits; infinite without a limit */
} sh_variable;

/* Sends a message to the user through the logger of the importer; format as in printf. */
typedef struct sh_instance sh_instance;
void sh_report(sh_instance *instance, sh_status status, const char *format, ...);

typedef struct {
    const char *identifier; /* modelIdentifier */
    const char *guid;       /* GUID of FMI 2.0, and instantiation token of FMI 3.0 */
    size_t size;            /* size of the model's struct */
    const sh_variable *variables;
    size_t count;
    /* The time derivative of the input at offset o is at o + derivative_offset. */
    size_t derivative_offset;
    /* Checks constraints between parameters, after the range of each parameter was checked. Returns
     * SH_OK, or SH_ERROR after a message. May be NULL.
     */
    sh_status (*check)(const void *model, sh_instance *log);
    /* Sets state and outputs at time t [s] from parameters and inputs. May be called again. */
    void (*initialize)(void *model, double t);
    /* Whether this can be the state of an initialised model, so that the model can advance. The
     * shell asks this for a state from outside, in which each parameter is in its range.
     */
    int (*is_state)(const void *model);
    /* Advances the model from t to t + h, h > 0. Inputs are u + du/dt (s - t) for s in
     * [t, t + h]. Returns SH_OK, SH_WARNING or SH_ERROR, and logs unless SH_OK.
     */
    sh_status (*step)(void *model, double t, double h, sh_instance *log);
} sh_model;

extern const sh_model sh_fmu_model;

/* Defines it, from variables.h and the functions initialize, is_state and step of the including file.
 */
#define SH_DEFINE_MODEL(Struct, offset_of_derivatives, check_or_null)                              \
    const sh_model sh_fmu_model = {                                                                \
        .identifier = SH_IDENTIFIER,                                                               \
        .guid = SH_GUID,                                                                           \
        .size = sizeof(Struct),                                                                    \
        .variables = VARIABLES,                                                                    \
        .count = sizeof VARIABLES / sizeof VARIABLES[0],                                           \
        .derivative_offset = (offset_of_derivatives),                                              \
        .check = (check_or_null),                                                                  \
        .initialize = initialize,                                                                  \
        .is_state = is_state,                                                                      \
        .step = step,                                                                              \
    }

#endif
