#include "state_block.h"

#include <stdint.h>
#include <string.h>

#include "value.h"

enum {
    GUID_LENGTH = 64,
    STATE_VERSION = 18 /* to be raised with every change of a model's struct: the GUID changes
                         with the variables only */
};

typedef struct {
    char magic[8];
    uint32_t version;
    uint32_t state; /* sh_state */
    char guid[GUID_LENGTH];
    double time, stop_time, steps, previous_step;
    uint64_t outputs_stale;
    uint64_t checksum; /* of all bytes of the block, taken with 0 in this place */
} state_header;

static const char MAGIC[8] = {'s', 'i', 'g', 'm', 'a', 'h', 'a', 't'};

size_t sh_block_size(void)
{
    return sizeof(state_header) + sh_fmu_model.size;
}

static state_header header_of(const void *block)
{
    state_header header;

    (void)memcpy(&header, block, sizeof header);
    return header;
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

void sh_block_write(const sh_instance *instance, void *block)
{
    state_header header;

    (void)memset(&header, 0, sizeof header);
    (void)memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = STATE_VERSION;
    header.state = (uint32_t)instance->state;
    (void)strncpy(header.guid, sh_fmu_model.guid, GUID_LENGTH - 1);
    header.time = instance->time;
    header.stop_time = instance->stop_time;
    header.steps = instance->steps;
    header.previous_step = instance->previous_step;
    header.outputs_stale = instance->outputs_stale != 0;
    (void)memcpy(block, &header, sizeof header);
    (void)memcpy((char *)block + sizeof header, instance->model, sh_fmu_model.size);
}

const char *sh_block_defect(const void *block)
{
    const state_header header = header_of(block);

    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0) {
        return "is not a state of a sigmahat FMU";
    }
    if (header.version != STATE_VERSION) {
        return "has another version of the format";
    }
    if (strncmp(header.guid, sh_fmu_model.guid, GUID_LENGTH) != 0) {
        return "is of another FMU or another version of it";
    }
    return NULL;
}

/* Copies the state of the simulation, without the model, from the header. */
static void read_header(sh_instance *instance, const void *block)
{
    const state_header header = header_of(block);

    instance->state = (sh_state)header.state;
    instance->time = header.time;
    instance->stop_time = header.stop_time;
    instance->steps = header.steps;
    instance->previous_step = header.previous_step;
    instance->outputs_stale = header.outputs_stale != 0;
    instance->parameters_unchecked = 1;        /* the next step checks the parameters */
    instance->slopes_end = sh_fmu_model.count; /* the state may have slopes */
}

void sh_block_read(sh_instance *instance, const void *block)
{
    read_header(instance, block);
    (void)memcpy(instance->model, (const char *)block + sizeof(state_header), sh_fmu_model.size);
}

void sh_block_sign(void *block)
{
    state_header header = header_of(block);

    header.checksum = checksum(block, sh_block_size());
    (void)memcpy(block, &header, sizeof header);
}

const char *sh_bytes_defect(const void *bytes, size_t size)
{
    const char *defect;

    if (size < sizeof(state_header)) {
        return "is truncated";
    }
    defect = sh_block_defect(bytes);
    if (defect != NULL) {
        return defect;
    }
    if (size != sh_block_size()) {
        return "is truncated or too long";
    }
    if (header_of(bytes).checksum != checksum(bytes, size)) {
        return "is damaged: its checksum does not match";
    }
    return NULL;
}

static int is_state(sh_state state)
{
    return state == SH_INSTANTIATED || state == SH_INITIALIZATION || state == SH_STEP ||
           state == SH_TERMINATED;
}

/* Whether the next step is possible without an initialisation of the model before. */
static int is_initialized(const sh_instance *shown)
{
    return shown->state == SH_STEP || (shown->state == SH_INITIALIZATION && !shown->outputs_stale);
}

int sh_block_is_sound(const sh_instance *instance, void *block, const char *function)
{
    sh_instance shown = *instance; /* with the model in the block */
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
