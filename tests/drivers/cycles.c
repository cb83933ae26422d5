/* cycles N: creates, initialises, steps and frees an instance, N times.
 *
 * Each instance also saves, serialises and restores its state, makes a call that is refused, and is
 * reset. Prints by how much the resident memory grew after the first tenth of the cycles.
 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "drive.h"

static long resident_memory(void)
{
    struct rusage usage;

    check(getrusage(RUSAGE_SELF, &usage) == 0, "getrusage");
    return usage.ru_maxrss;
}

static void copy_state(fmi2Component instance)
{
    fmi2FMUstate state = NULL, copy = NULL;
    fmi2Byte *bytes;
    size_t size;

    check(fmi2GetFMUstate(instance, &state) == fmi2OK, "fmi2GetFMUstate");
    check(fmi2SerializedFMUstateSize(instance, state, &size) == fmi2OK, "size");
    bytes = malloc(size);
    check(bytes != NULL, "malloc");
    check(fmi2SerializeFMUstate(instance, state, bytes, size) == fmi2OK, "serialise");
    check(fmi2DeSerializeFMUstate(instance, bytes, size, &copy) == fmi2OK, "deserialise");
    bytes[size / 2] ^= 1;
    check(fmi2DeSerializeFMUstate(instance, bytes, size, &copy) == fmi2Error,
          "a damaged state is refused");
    free(bytes);
    step(instance, 0, 1);
    check(fmi2SetFMUstate(instance, copy) == fmi2OK, "fmi2SetFMUstate");
    check(fmi2FreeFMUstate(instance, &state) == fmi2OK, "fmi2FreeFMUstate");
    check(fmi2FreeFMUstate(instance, &copy) == fmi2OK, "fmi2FreeFMUstate");
}

static void cycle(void)
{
    const fmi2ValueReference unknown = 1000000;
    double values[256];
    fmi2Component instance = start();

    step(instance, 0, 0);
    copy_state(instance);
    step(instance, 0, 1);
    get_outputs(instance, values);
    check(fmi2GetReal(instance, &unknown, 1, values) == fmi2Error, "refused");
    check(fmi2Terminate(instance) == fmi2OK, "fmi2Terminate");
    check(fmi2Reset(instance) == fmi2OK, "fmi2Reset");
    fmi2FreeInstance(instance);
}

int main(int argc, char **argv)
{
    long cycles, before = 0, k;

    check(argc == 2, "expected the number of cycles");
    cycles = strtol(argv[1], NULL, 10);
    for (k = 0; k < cycles; ++k) {
        if (k == cycles / 10)
            before = resident_memory();
        cycle();
    }
    printf("%ld\n", resident_memory() - before);
    return 0;
}
