/* FMI 2.0: saving, restoring and serialising the state of the FMU.
 *
 * A saved state is one block without pointers: this header, then the model's
 * struct. Serialised, it is the same bytes; version, GUID, length and checksum
 * show whether a block is damaged or of another FMU.
 */
#include <stdint.h>
#include <string.h>

#include "instance.h"

enum {
    GUID_LENGTH = 64,
    STATE_VERSION = 7 /* to be raised with every change of a model's struct: the GUID changes
                         with the variables only */
};

typedef struct {
    char magic[8];
    uint32_t version;
    uint32_t state; /* sh_state */
    uint64_t size;  /* of header and model */
    char guid[GUID_LENGTH];
    double time;
    int32_t outputs_stale, parameters_unchecked;
    uint64_t checksum; /* of all bytes of the block, taken with 0 in this place */
} state_header;

static const char MAGIC[8] = {'s', 'i', 'g', 'm', 'a', 'h', 'a', 't'};

static size_t block_size(void)
{
    return sizeof(state_header) + sh_fmu_model.size;
}

/* FNV-1a, 64 bit: https://datatracker.ietf.org/doc/html/draft-eastlake-fnv */
static uint64_t checksum(const unsigned char *block, size_t size)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    const size_t hole = offsetof(state_header, checksum);
    size_t i;

    for (i = 0; i < size; ++i) {
        const unsigned char byte = i >= hole && i < hole + sizeof hash ? 0 : block[i];
        hash = (hash ^ byte) * UINT64_C(1099511628211);
    }
    return hash;
}

/* NULL if the block is a state of this FMU, else what is wrong with it. */
static const char *defect(const void *block, size_t size)
{
    state_header header;

    if (size < sizeof header)
        return "is truncated";
    memcpy(&header, block, sizeof header);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0)
        return "is not a state of a sigmahat FMU";
    if (header.version != STATE_VERSION)
        return "has another version of the format";
    if (strncmp(header.guid, sh_fmu_model.guid, GUID_LENGTH) != 0)
        return "is of another FMU or another version of it";
    if (header.size != block_size() || size != block_size())
        return "is truncated or too long";
    if (header.checksum != checksum(block, size))
        return "is damaged: its checksum does not match";
    return NULL;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2GetFMUstate");
    state_header header;
    unsigned char *block;

    if (instance == NULL || !sh_has(instance, FMUstate, "fmi2GetFMUstate", "FMUstate"))
        return fmi2Error;
    /* A state from an earlier call may be handed in, to be overwritten. */
    block = *FMUstate != NULL ? *FMUstate : sh_allocate(&instance->callbacks, block_size());
    if (block == NULL) {
        sh_log(instance, fmi2Error, "fmi2GetFMUstate: out of memory.");
        return fmi2Error;
    }
    memset(&header, 0, sizeof header);
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = STATE_VERSION;
    header.state = (uint32_t)instance->state;
    header.size = block_size();
    strncpy(header.guid, sh_fmu_model.guid, GUID_LENGTH - 1);
    header.time = instance->time;
    header.outputs_stale = instance->outputs_stale;
    header.parameters_unchecked = instance->parameters_unchecked;
    memcpy(block, &header, sizeof header);
    memcpy(block + sizeof header, instance->model, sh_fmu_model.size);
    header.checksum = checksum(block, block_size());
    memcpy(block, &header, sizeof header);
    *FMUstate = block;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2SetFMUstate");
    const unsigned char *block = FMUstate;
    state_header header;
    const char *what;

    if (instance == NULL || !sh_has(instance, FMUstate, "fmi2SetFMUstate", "FMUstate"))
        return fmi2Error;
    what = defect(block, block_size());
    if (what != NULL) {
        sh_log(instance, fmi2Error, "fmi2SetFMUstate: the state %s.", what);
        return fmi2Error;
    }
    memcpy(&header, block, sizeof header);
    memcpy(instance->model, block + sizeof header, sh_fmu_model.size);
    instance->state = (sh_state)header.state;
    instance->time = header.time;
    instance->outputs_stale = header.outputs_stale;
    instance->parameters_unchecked = header.parameters_unchecked;
    instance->slopes_set = 1; /* the state may have some */
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2FreeFMUstate");

    if (instance == NULL)
        return fmi2Error;
    if (FMUstate != NULL) {
        sh_release(&instance->callbacks, *FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2SerializedFMUstateSize");

    if (instance == NULL || !sh_has(instance, FMUstate, "fmi2SerializedFMUstateSize", "FMUstate") ||
        !sh_has(instance, size, "fmi2SerializedFMUstateSize", "size"))
        return fmi2Error;
    *size = block_size();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2SerializeFMUstate");

    if (instance == NULL || !sh_has(instance, FMUstate, "fmi2SerializeFMUstate", "FMUstate") ||
        !sh_has(instance, serializedState, "fmi2SerializeFMUstate", "serializedState"))
        return fmi2Error;
    if (size < block_size()) {
        sh_log(instance, fmi2Error, "fmi2SerializeFMUstate: size = %lu bytes; expected %lu.",
               (unsigned long)size, (unsigned long)block_size());
        return fmi2Error;
    }
    memcpy(serializedState, FMUstate, block_size());
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    sh_instance *instance = sh_enter(c, SH_ANY, "fmi2DeSerializeFMUstate");
    const char *what;
    void *block;

    if (instance == NULL ||
        !sh_has(instance, serializedState, "fmi2DeSerializeFMUstate", "serializedState") ||
        !sh_has(instance, FMUstate, "fmi2DeSerializeFMUstate", "FMUstate"))
        return fmi2Error;
    what = defect(serializedState, size);
    if (what != NULL) {
        sh_log(instance, fmi2Error, "fmi2DeSerializeFMUstate: the state (%lu bytes) %s.",
               (unsigned long)size, what);
        return fmi2Error;
    }
    block = sh_allocate(&instance->callbacks, block_size());
    if (block == NULL) {
        sh_log(instance, fmi2Error, "fmi2DeSerializeFMUstate: out of memory.");
        return fmi2Error;
    }
    memcpy(block, serializedState, block_size());
    *FMUstate = block;
    return fmi2OK;
}
