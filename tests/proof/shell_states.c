/* The de-serialiser: any bytes of any length, then the state that they make, then a step; and every
 * call of an instance in any state that can be restored.
 */
#include <stdlib.h>
#include <string.h>

#include "__fc_builtin.h"
#include "saved_state.h"
#include "shell_importer.h"
#include "state_block.h"

enum { HEADER = 136, PLACE_OF_STATE = 12, PLACE_OF_FLAGS = 120 };

/* For the proof of other files. */
/*@ requires \valid(instance) && \valid_read(format);
    assigns \nothing; */
void sh_log(sh_instance *instance, sh_status status, const char *format, ...);

static MODEL model;
static char name[] = "x";

static sh_instance instance_with(void *own, int own_memory)
{
    sh_instance instance = {0};

    if (own_memory) {
        instance.importer.allocate = allocate;
        instance.importer.release = release;
    }
    instance.name = name;
    instance.categories = (unsigned)any_int();
    instance.state = SH_INSTANTIATED;
    instance.time = any_real();
    instance.stop_time = any_real();
    instance.steps = any_real();
    instance.previous_step = any_real();
    instance.outputs_stale = any_choice();
    instance.parameters_unchecked = any_choice();
    instance.slopes_set = any_choice();
    instance.model = own;
    return instance;
}

/* Bytes of any content that are too few or too many: a shorter array than `least` cannot be meant. */
static void of_another_size(size_t length, size_t least, size_t most)
{
    sh_instance instance = instance_with(&model, 0);
    const size_t size = Frama_C_size_t_interval(least, most);
    void *state = NULL;

    sh_deserialize_state(&instance, any_bytes(length), size, &state, "proof");
    //@ assert refused: state == \null;
}

/* A state of the right size. Where its simulation stands is given; the rest may be anything. */
static void of_this_size(unsigned course, int stale, int unchecked, int own_memory)
{
    sh_instance instance = instance_with(&model, own_memory);
    const size_t size = sh_block_size();
    char *bytes = any_bytes(size);
    const int flags[2] = {stale, unchecked};
    void *state = NULL;

    memcpy(bytes + PLACE_OF_STATE, &course, sizeof course);
    memcpy(bytes + PLACE_OF_FLAGS, flags, sizeof flags);
    if (sh_deserialize_state(&instance, bytes, size, &state, "proof") != SH_OK) {
        return;
    }
    if (sh_restore_state(&instance, state, "proof") == SH_OK) {
        //@ assert taken: instance.state == course;
        if (course != SH_INITIALIZATION || sh_end_initialization(&instance, "proof") == SH_OK) {
            sh_communication_step(&instance, any_real(), any_real(), "proof");
        }
    }
    sh_free_state(&instance, &state, "proof");
    //@ assert freed: state == \null;
}

/* A state whose memory has been changed since. */
static void of_changed_memory(void)
{
    sh_instance instance = instance_with(&model, 0);

    sh_restore_state(&instance, any_bytes(sh_block_size()), "proof");
}

int main(void)
{
    Frama_C_make_unknown((char *)&model, sizeof model);
    of_another_size(0, 0, HEADER - 1);
    of_another_size(HEADER, HEADER, HEADER + sizeof model - 1);
    of_another_size(HEADER, HEADER + sizeof model + 1, SIZE_MAX);
    of_changed_memory();
    of_this_size(SH_INSTANTIATED, any_int(), any_int(), 0);
    of_this_size(SH_TERMINATED, any_int(), any_int(), 0);
    of_this_size(SH_INITIALIZATION, 1, 0, 1);
    of_this_size(SH_INITIALIZATION, 1, 1, 0);
    of_this_size(SH_INITIALIZATION, 0, 0, 0);
    of_this_size(SH_INITIALIZATION, 0, 1, 0);
    of_this_size(SH_STEP, any_int(), 0, 0);
    of_this_size(SH_STEP, any_int(), 1, 0);
    return 0;
}

/* One call of every kind, with any arguments. */
static void call(int which, sh_instance *instance)
{
    const sh_experiment experiment = {any_int(), any_real(), any_real(), any_int(), any_real()};
    void *state = NULL;
    size_t size = 0;

    switch (which) {
    case 0:
        sh_set_up(instance, &experiment, "proof");
        break;
    case 1:
        sh_begin_initialization(instance, "proof");
        break;
    case 2:
        sh_end_initialization(instance, "proof");
        break;
    case 3:
        sh_communication_step(instance, any_real(), any_real(), "proof");
        break;
    case 4:
        sh_terminate(instance, "proof");
        break;
    case 5:
        sh_reset(instance);
        break;
    case 6:
        sh_initialize(instance);
        break;
    default:
        sh_save_state(instance, &state, "proof");
        sh_state_size(instance, state, &size, "proof");
        sh_free_state(instance, &state, "proof");
        break;
    }
}

static void calls_of(unsigned course, int stale, int unchecked)
{
    const int flags[2] = {stale, unchecked};
    int which;

    //@ loop unroll 8;
    for (which = 0; which < 8; ++which) {
        sh_instance instance = instance_with(&model, 1);
        const size_t size = sh_block_size();
        char *bytes = any_bytes(size);

        (void)memcpy(bytes + PLACE_OF_STATE, &course, sizeof course);
        (void)memcpy(bytes + PLACE_OF_FLAGS, flags, sizeof flags);
        if (sh_restore_state(&instance, bytes, "proof") == SH_OK) {
            call(which, &instance);
        }
        free(bytes);
    }
}

/* Every call, from every state that an instance can have. */
void calls(void)
{
    Frama_C_make_unknown((char *)&model, sizeof model);
    calls_of(SH_INSTANTIATED, 1, 0);
    calls_of(SH_INSTANTIATED, 1, 1);
    calls_of(SH_TERMINATED, 0, 0);
    calls_of(SH_TERMINATED, 0, 1);
    calls_of(SH_INITIALIZATION, 1, 0);
    calls_of(SH_INITIALIZATION, 1, 1);
    calls_of(SH_INITIALIZATION, 0, 0);
    calls_of(SH_INITIALIZATION, 0, 1);
    calls_of(SH_STEP, 0, 0);
    calls_of(SH_STEP, 0, 1);
    //@ assert reached: \true;
}
