/* A saved state is a block of bytes without pointers: a header, followed by the model's struct. A serialised state
 * has the same bytes as a saved state. Version, GUID, length and checksum show whether a block is damaged or belongs to
 * another FMU.
 */
#include "saved_state.h"

#include <stdint.h>
#include <string.h>

#include "allocation.h"
#include "guards.h"
#include "saved_bytes.h"

enum { GUID_LENGTH = 64 };

typedef struct {
    char magic[8];
    uint32_t version;
    uint32_t state; /* sh_state */
    char guid[GUID_LENGTH];
    double time, stop_time, steps, previous_step;
    uint32_t outputs_stale, slopes_end;
    uint64_t checksum; /* checksum of the whole block, computed with checksum = 0 */
} state_header;

static const char MAGIC[8] = {'s', 'i', 'g', 'm', 'a', 'h', 'a', 't'};

static size_t block_size(void)
{
    return sizeof(state_header) + sh_fmu_model.size;
}

static state_header header_of(const void *block)
{
    state_header header;

    (void)memcpy(&header, block, sizeof header);
    return header;
}

static uint64_t checksum(const void *block)
{
    return sh_checksum(block, block_size(), offsetof(state_header, checksum));
}

/* Writes the state of an instance to a block, whose checksum remains 0. */
static void write_block(const sh_instance *instance, void *block)
{
    state_header header;

    (void)memset(&header, 0, sizeof header);
    (void)memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = SH_STATE_VERSION;
    header.state = (uint32_t)instance->state;
    (void)strncpy(header.guid, sh_fmu_model.guid, GUID_LENGTH - 1);
    header.time = instance->time;
    header.stop_time = instance->stop_time;
    header.steps = instance->steps;
    header.previous_step = instance->previous_step;
    header.outputs_stale = instance->outputs_stale != 0;
    header.slopes_end = (uint32_t)instance->slopes_end;
    (void)memcpy(block, &header, sizeof header);
    (void)memcpy((char *)block + sizeof header, instance->model, sh_fmu_model.size);
}

/* Checks the header of a block. Returns NULL if the block is a state of this FMU, else the defect as text. */
static const char *defect_of_block(const void *block)
{
    const state_header header = header_of(block);

    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0) {
        return "is not a state of a sigmahat FMU";
    }
    if (header.version != SH_STATE_VERSION) {
        return "has another version of the format";
    }
    if (strncmp(header.guid, sh_fmu_model.guid, GUID_LENGTH) != 0) {
        return "is of another FMU or another version of it";
    }
    return NULL;
}

/* Copies the state of the simulation from the header of a block to an instance, but not the model's struct. */
static void read_header(sh_instance *instance, const void *block)
{
    const state_header header = header_of(block);

    instance->state = (sh_state)header.state;
    instance->time = header.time;
    instance->stop_time = header.stop_time;
    instance->steps = header.steps;
    instance->previous_step = header.previous_step;
    instance->outputs_stale = header.outputs_stale != 0;
    instance->parameters_unchecked = 1; /* the next step must check the parameters */
    instance->slopes_end =
        header.slopes_end < sh_fmu_model.count ? header.slopes_end : sh_fmu_model.count;
}

/* Checks a serialised state. Returns NULL if the state is valid, else the defect as text, such as "is truncated". */
static const char *defect_of_bytes(const void *bytes, size_t size)
{
    const char *defect;

    if (size < sizeof(state_header)) {
        return "is truncated";
    }
    defect = defect_of_block(bytes);
    if (defect != NULL) {
        return defect;
    }
    if (size != block_size()) {
        return "is truncated or too long";
    }
    if (header_of(bytes).checksum != checksum(bytes)) {
        return "is damaged: its checksum does not match";
    }
    return NULL;
}

static int is_state(sh_state state)
{
    return state == SH_INSTANTIATED || state == SH_INITIALIZATION || state == SH_STEP ||
           state == SH_TERMINATED;
}

/* Returns 1 if the next step is possible without another initialisation of the model. */
static int is_initialized(const sh_instance *shown)
{
    return shown->state == SH_STEP || (shown->state == SH_INITIALIZATION && !shown->outputs_stale);
}

/* Returns 1 if an instance can continue from a deserialised block, else 0 after a message. A check of values is
 * necessary because a manipulated block may have a valid checksum.
 */
static int is_sound(const sh_instance *instance, void *block, const char *function)
{
    sh_instance shown = *instance; /* copy of the instance that uses the model in the block */
    size_t i;

    read_header(&shown, block);
    shown.model = (char *)block + sizeof(state_header);
    for (i = 0; i < sh_fmu_model.count; ++i) {
        const sh_variable *variable = &sh_fmu_model.variables[i];
        if (!sh_accepts(&shown, variable, sh_read(&shown, variable), function)) {
            return 0;
        }
    }
    if (is_state(shown.state) && (!is_initialized(&shown) || sh_fmu_model.is_state(shown.model))) {
        return 1;
    }
    sh_report(&shown, SH_ERROR, "%s: the state contains values that this FMU never saves.",
              function);
    return 0;
}

sh_status sh_save_state(void *handle, void **state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    void *block;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    /* The importer may pass a state from an earlier call, which is overwritten. */
    block = *state != NULL ? *state : sh_allocate(&instance->importer, block_size());
    if (block == NULL) {
        sh_report(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    write_block(instance, block);
    *state = block;
    return SH_OK;
}

sh_status sh_restore_state(void *handle, void *state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    const char *what;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    what = defect_of_block(state);
    if (what != NULL) {
        sh_report(instance, SH_ERROR, "%s: the state %s.", function, what);
        return SH_ERROR;
    }
    read_header(instance, state);
    (void)memcpy(instance->model, (const char *)state + sizeof(state_header), sh_fmu_model.size);
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
    state_header header;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState") ||
        !sh_has(instance, bytes, function, "serializedState")) {
        return SH_ERROR;
    }
    if (size < block_size()) {
        sh_report(instance, SH_ERROR, "%s: size = %lu bytes; expected %lu.", function,
                  (unsigned long)size, (unsigned long)block_size());
        return SH_ERROR;
    }
    (void)memcpy(bytes, state, block_size());
    header = header_of(bytes);
    header.checksum = checksum(bytes);
    (void)memcpy(bytes, &header, sizeof header);
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
    what = defect_of_bytes(bytes, size);
    if (what != NULL) {
        sh_report(instance, SH_ERROR, "%s: the state (%lu bytes) %s.", function,
                  (unsigned long)size, what);
        return SH_ERROR;
    }
    block = sh_allocate(&instance->importer, block_size());
    if (block == NULL) {
        sh_report(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    (void)memcpy(block, bytes, block_size());
    if (!is_sound(instance, block, function)) {
        sh_release(&instance->importer, block);
        return SH_ERROR;
    }
    *state = block;
    return SH_OK;
}
