/* cycles N: creates, initialises, steps and frees an instance, N times.
 *
 * Each instance also saves, serialises and restores its state, makes a call that is refused, and is
 * reset. A checker of memory sees what they leave behind.
 */
#include <stdlib.h>

#include "drive.h"
#include "fmi_calls.h"

static void copy_state(void *instance)
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
    step(instance, 0, 1);
    check(fmi_set_state(instance, copy) == SH_OK, "set the state");
    check(fmi_free_state(instance, &state) == SH_OK, "free the state");
    check(fmi_free_state(instance, &copy) == SH_OK, "free the state");
}

static void cycle(void)
{
    const uint32_t unknown = 1000000;
    double values[256];
    void *instance = start();

    step(instance, 0, 0);
    copy_state(instance);
    step(instance, 0, 1);
    get_outputs(instance, values);
    check(fmi_get_reals(instance, &unknown, 1, values) == SH_ERROR, "refused");
    check(fmi_terminate(instance) == SH_OK, "terminate");
    check(fmi_reset(instance) == SH_OK, "reset");
    fmi_free_instance(instance);
}

int main(int argc, char **argv)
{
    long k;

    check(argc == 2, "expected the number of cycles");
    for (k = strtol(argv[1], NULL, 10); k > 0; --k) {
        cycle();
    }
    return 0;
}
