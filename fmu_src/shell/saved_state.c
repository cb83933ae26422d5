/* Saving, restoring and serialising the state of the FMU, the same in every version of FMI.
 *
 * A saved state is one block without pointers: this header, then the model's
 * struct. Serialised, it is the same bytes; version, GUID, length and checksum
 * show whether a block is damaged or of another FMU.
 */
#include <stdint.h>
#include <string.h>

#include "saved_state.h"

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
    double time, stop_time, steps, previous_step;
    int32_t outputs_stale, parameters_unchecked;
    uint64_t checksum; /* of all bytes of the block, taken with 0 in this place */
} state_header;

static const char MAGIC[8] = {'s', 'i', 'g', 'm', 'a', 'h', 'a', 't'};

static size_t block_size(void)
{
    return sizeof(state_header) + sh_fmu_model.size;
}

/* FNV-1a, 64 bit: datatracker.ietf.org/doc/html/draft-eastlake-fnv */
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

    if (size < sizeof header) {
        return "is truncated";
    }
    (void)memcpy(&header, block, sizeof header);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0) {
        return "is not a state of a sigmahat FMU";
    }
    if (header.version != STATE_VERSION) {
        return "has another version of the format";
    }
    if (strncmp(header.guid, sh_fmu_model.guid, GUID_LENGTH) != 0) {
        return "is of another FMU or another version of it";
    }
    if (header.size != block_size() || size != block_size()) {
        return "is truncated or too long";
    }
    if (header.checksum != checksum(block, size)) {
        return "is damaged: its checksum does not match";
    }
    return NULL;
}

sh_status sh_save_state(void *handle, void **state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    state_header header;
    unsigned char *block;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    /* A state from an earlier call may be handed in, to be overwritten. */
    block = *state != NULL ? *state : sh_allocate(&instance->importer, block_size());
    if (block == NULL) {
        sh_log(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    (void)memset(&header, 0, sizeof header);
    (void)memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = STATE_VERSION;
    header.state = (uint32_t)instance->state;
    header.size = block_size();
    (void)strncpy(header.guid, sh_fmu_model.guid, GUID_LENGTH - 1);
    header.time = instance->time;
    header.stop_time = instance->stop_time;
    header.steps = instance->steps;
    header.previous_step = instance->previous_step;
    header.outputs_stale = instance->outputs_stale;
    header.parameters_unchecked = instance->parameters_unchecked;
    (void)memcpy(block, &header, sizeof header);
    (void)memcpy(block + sizeof header, instance->model, sh_fmu_model.size);
    header.checksum = checksum(block, block_size());
    (void)memcpy(block, &header, sizeof header);
    *state = block;
    return SH_OK;
}

sh_status sh_restore_state(void *handle, const void *state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    const unsigned char *block = state;
    state_header header;
    const char *what;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    what = defect(block, block_size());
    if (what != NULL) {
        sh_log(instance, SH_ERROR, "%s: the state %s.", function, what);
        return SH_ERROR;
    }
    (void)memcpy(&header, block, sizeof header);
    (void)memcpy(instance->model, block + sizeof header, sh_fmu_model.size);
    instance->state = (sh_state)header.state;
    instance->time = header.time;
    instance->stop_time = header.stop_time;
    instance->steps = header.steps;
    instance->previous_step = header.previous_step;
    instance->outputs_stale = header.outputs_stale;
    instance->parameters_unchecked = header.parameters_unchecked;
    instance->slopes_set = 1; /* the state may have some */
    return SH_OK;
}

sh_status sh_free_state(void *handle, void **state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);

    if (instance == NULL) {
        return SH_ERROR;
    }
    if (state != NULL) {
        sh_release(&instance->importer, *state);
        *state = NULL;
    }
    return SH_OK;
}

sh_status sh_state_size(void *handle, const void *state, size_t *size, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);

    if (instance == NULL || !sh_has(instance, state, function, "FMUState") ||
        !sh_has(instance, size, function, "size")) {
        return SH_ERROR;
    }
    *size = block_size();
    return SH_OK;
}

sh_status sh_serialize_state(void *handle, const void *state, void *bytes, size_t size,
                             const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);

    if (instance == NULL || !sh_has(instance, state, function, "FMUState") ||
        !sh_has(instance, bytes, function, "serializedState")) {
        return SH_ERROR;
    }
    if (size < block_size()) {
        sh_log(instance, SH_ERROR, "%s: size = %lu bytes; expected %lu.", function,
               (unsigned long)size, (unsigned long)block_size());
        return SH_ERROR;
    }
    (void)memcpy(bytes, state, block_size());
    return SH_OK;
}

sh_status sh_deserialize_state(void *handle, const void *bytes, size_t size, void **state,
                               const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    const char *what;
    void *block;

    if (instance == NULL || !sh_has(instance, bytes, function, "serializedState") ||
        !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    what = defect(bytes, size);
    if (what != NULL) {
        sh_log(instance, SH_ERROR, "%s: the state (%lu bytes) %s.", function, (unsigned long)size,
               what);
        return SH_ERROR;
    }
    block = sh_allocate(&instance->importer, block_size());
    if (block == NULL) {
        sh_log(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    (void)memcpy(block, bytes, block_size());
    *state = block;
    return SH_OK;
}
