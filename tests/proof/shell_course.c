/* The life of an instance: created, set up, initialised, stepped, saved, reset and destroyed, with any
 * arguments, and with memory that may run out. Each call but the first and the last may be left out.
 */
#include <stdlib.h>

#include "__fc_builtin.h"
#include "saved_state.h"
#include "shell_importer.h"

/*@ requires \valid(instance) && \valid_read(format);
    assigns \nothing; */
void sh_log(sh_instance *instance, sh_status status, const char *format, ...);

static void live(const sh_importer *importer, const char *name)
{
    const sh_experiment experiment = {any_int(), any_real(), any_real(), any_int(), any_real()};
    void *state = NULL;
    sh_instance *instance =
        sh_create(importer, name, sh_fmu_model.guid, (unsigned)any_int(), "proof");

    if (instance == NULL) {
        return;
    }
    if (any_choice()) {
        sh_set_up(instance, &experiment, "proof");
    }
    if (any_choice()) {
        sh_begin_initialization(instance, "proof");
    }
    if (sh_end_initialization(instance, "proof") == SH_OK) {
        sh_communication_step(instance, any_real(), any_real(), "proof");
    }
    if (any_choice()) {
        sh_save_state(instance, &state, "proof");
    }
    if (any_choice()) {
        sh_terminate(instance, "proof");
    }
    if (any_choice()) {
        sh_reset(instance);
    }
    sh_free_state(instance, &state, "proof");
    sh_destroy(instance);
}

int main(void)
{
    static const sh_importer OWN = {NULL, NULL, allocate, release}, NONE = {NULL, NULL, NULL, NULL};

    sh_create(&NONE, NULL, NULL, 0, "proof");
    sh_create(&OWN, "x", "another", 0, "proof");
    live(&NONE, "");
    live(&OWN, "joint");
    return 0;
}
