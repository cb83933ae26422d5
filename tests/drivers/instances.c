/* Runs four instances one after the other, then each in its own thread. The outputs of sequential and parallel runs
 * must be equal bit for bit.
 *
 * An instance also saves, serialises and restores its state, makes a call that is
 * refused, and is reset. A memory checker finds memory that is not freed.
 */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"

enum { INSTANCES = 4, STEPS = 40, OUTPUTS = 256 };

typedef struct {
    int variant;
    double outputs[STEPS][OUTPUTS];
} run;

/* A copy of the state that was serialised in between. */
static void *copy_state(void *instance)
{
    void *state = NULL, *copy = NULL;
    uint8_t *bytes;
    size_t size;

    check(fmi_get_state(instance, &state) == SH_OK, "get the state");
    check(fmi_state_size(instance, state, &size) == SH_OK, "size");
    bytes = malloc(size);
    check(bytes != NULL, "malloc");
    check(fmi_serialize_state(instance, state, bytes, size) == SH_OK, "serialise");
    check(fmi_deserialize_state(instance, bytes, size, &copy) == SH_OK, "deserialise");
    bytes[size / 2] ^= 1;
    check(fmi_deserialize_state(instance, bytes, size, &copy) == SH_ERROR,
          "a damaged state is refused");
    free(bytes);
    check(fmi_free_state(instance, &state) == SH_OK, "free the state");
    return copy;
}

static void *run_alone(void *argument)
{
    const uint32_t unknown = 1000000;
    run *own = argument;
    void *instance = fmi_instantiate(sh_fmu_model.guid), *state;
    double value;
    long k;

    check(instance != NULL, "instantiate");
    fmi_initialize(instance);
    for (k = 0; k < STEPS; ++k) {
        if (k == STEPS / 2) {
            state = copy_state(instance);
            step(instance, own->variant + 1, k);
            check(fmi_set_state(instance, state) == SH_OK, "set the state");
            check(fmi_free_state(instance, &state) == SH_OK, "free the copy");
        }
        step(instance, own->variant, k);
        get_outputs(instance, own->outputs[k]);
    }
    check(fmi_get_reals(instance, &unknown, 1, &value) == SH_ERROR, "refused");
    check(fmi_terminate(instance) == SH_OK, "terminate");
    check(fmi_reset(instance) == SH_OK, "reset");
    fmi_free_instance(instance);
    return NULL;
}

int main(void)
{
    static run separate[INSTANCES], in_threads[INSTANCES];
    pthread_t threads[INSTANCES];
    int i;

    for (i = 0; i < INSTANCES; ++i) {
        separate[i].variant = in_threads[i].variant = i;
        run_alone(&separate[i]);
    }
    check(memcmp(separate[0].outputs, separate[1].outputs, sizeof separate[0].outputs) != 0,
          "the instances differ");
    for (i = 0; i < INSTANCES; ++i) {
        check(pthread_create(&threads[i], NULL, run_alone, &in_threads[i]) == 0, "pthread_create");
    }
    for (i = 0; i < INSTANCES; ++i) {
        check(pthread_join(threads[i], NULL) == 0, "pthread_join");
    }
    check(memcmp(in_threads, separate, sizeof separate) == 0,
          "instances in threads give what they give alone");
    return 0;
}
