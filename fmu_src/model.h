/* What a model provides for the FMI shell (fmi2_*.c): one constant of type sh_model.
 *
 * A model is one plain struct without pointers that holds parameters, inputs,
 * outputs and state. The shell allocates it, reaches its variables through the
 * table generated from the model description, and copies it as a whole to save
 * and restore the state of the FMU.
 */
#ifndef SH_MODEL_H
#define SH_MODEL_H

#include <stddef.h>

#include "fmi2FunctionTypes.h"

typedef enum { SH_TYPE_REAL, SH_TYPE_INTEGER, SH_TYPE_BOOLEAN } sh_type;

typedef enum {
    SH_ROLE_INPUT,
    SH_ROLE_OUTPUT,
    SH_ROLE_GUESS,  /* output with a start value; the model overwrites it */
    SH_ROLE_FIXED,  /* parameter, settable until the end of initialisation */
    SH_ROLE_TUNABLE /* parameter, also settable between steps */
} sh_role;

/* One variable. Its value reference is its place in the table. */
typedef struct {
    const char *name;
    size_t offset; /* in the model's struct, of a double (Real) or an int */
    sh_type type;
    sh_role role;
    double start;
    double min, max; /* allowed values, both limits among them; infinite where there is none */
} sh_variable;

/* Sends a message to the user through the logger of the importer; format as in printf. */
typedef struct sh_instance sh_instance;
void sh_log(sh_instance *instance, fmi2Status status, const char *format, ...);

typedef struct {
    const char *identifier; /* modelIdentifier */
    const char *guid;
    size_t size; /* of the model's struct */
    const sh_variable *variables;
    size_t count;
    /* The time derivative of the input at offset o is at o + derivative_offset. */
    size_t derivative_offset;
    /* Checks constraints between parameters, after the range of each one. Returns fmi2OK, or
     * fmi2Error after a message. May be NULL.
     */
    fmi2Status (*check)(const void *model, sh_instance *log);
    /* Sets state and outputs from parameters and inputs. May be called again. */
    void (*initialize)(void *model);
    /* Advances the model from t to t + h. Inputs are u + du/dt (s - t) for s in
     * [t, t + h]. Returns fmi2OK, fmi2Warning or fmi2Error, and logs unless fmi2OK.
     */
    fmi2Status (*step)(void *model, double t, double h, sh_instance *log);
} sh_model;

extern const sh_model sh_fmu_model;

#endif
