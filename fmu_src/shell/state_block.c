#include "state_block.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum {
    GUID_LENGTH = 64,
    STATE_VERSION = 9 /* to be raised with every change of a model's struct: the GUID changes
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

size_t sh_block_size(void)
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

const char *sh_block_defect(const void *bytes, size_t size)
{
    state_header header;

    if (size < sizeof header) {
        return "is truncated";
    }
    (void)memcpy(&header, bytes, sizeof header);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0) {
        return "is not a state of a sigmahat FMU";
    }
    if (header.version != STATE_VERSION) {
        return "has another version of the format";
    }
    if (strncmp(header.guid, sh_fmu_model.guid, GUID_LENGTH) != 0) {
        return "is of another FMU or another version of it";
    }
    if (header.size != sh_block_size() || size != sh_block_size()) {
        return "is truncated or too long";
    }
    if (header.checksum != checksum(bytes, size)) {
        return "is damaged: its checksum does not match";
    }
    return NULL;
}

void sh_block_write(const sh_instance *instance, void *block)
{
    state_header header;

    (void)memset(&header, 0, sizeof header);
    (void)memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = STATE_VERSION;
    header.state = (uint32_t)instance->state;
    header.size = sh_block_size();
    (void)strncpy(header.guid, sh_fmu_model.guid, GUID_LENGTH - 1);
    header.time = instance->time;
    header.stop_time = instance->stop_time;
    header.steps = instance->steps;
    header.previous_step = instance->previous_step;
    header.outputs_stale = instance->outputs_stale;
    header.parameters_unchecked = instance->parameters_unchecked;
    (void)memcpy(block, &header, sizeof header);
    (void)memcpy((char *)block + sizeof header, instance->model, sh_fmu_model.size);
    header.checksum = checksum(block, sh_block_size());
    (void)memcpy(block, &header, sizeof header);
}

sh_instance sh_block_instance(const sh_instance *instance, void *block)
{
    sh_instance shown = *instance;
    state_header header;

    (void)memcpy(&header, block, sizeof header);
    shown.state = (sh_state)header.state;
    shown.time = header.time;
    shown.stop_time = header.stop_time;
    shown.steps = header.steps;
    shown.previous_step = header.previous_step;
    shown.outputs_stale = header.outputs_stale;
    shown.parameters_unchecked = header.parameters_unchecked;
    shown.slopes_set = 1; /* the state may have some */
    shown.model = (char *)block + sizeof header;
    return shown;
}

static int is_flag(int value)
{
    return value == 0 || value == 1;
}

/* Whether the instance stands somewhere in a simulation. */
static int has_course(const sh_instance *shown)
{
    return (shown->state == SH_INSTANTIATED || shown->state == SH_INITIALIZATION ||
            shown->state == SH_STEP || shown->state == SH_TERMINATED) &&
           isfinite(shown->time) && !isnan(shown->stop_time) && isfinite(shown->steps) &&
           isfinite(shown->previous_step) && is_flag(shown->outputs_stale) &&
           is_flag(shown->parameters_unchecked);
}

/* Whether the next step can come without the model being initialised before. */
static int is_initialized(const sh_instance *shown)
{
    return shown->state == SH_STEP || (shown->state == SH_INITIALIZATION && !shown->outputs_stale);
}

int sh_block_is_sound(sh_instance *shown, const char *function)
{
    if (has_course(shown)) {
        if (sh_check_ranges(shown, function) != SH_OK) {
            return 0;
        }
        /* Those that the importer has set are checked before the next step. */
        if (!shown->parameters_unchecked && sh_fmu_model.check != NULL &&
            sh_fmu_model.check(shown->model, shown) != SH_OK) {
            return 0;
        }
        if (!is_initialized(shown) || sh_fmu_model.is_state(shown->model)) {
            return 1;
        }
    }
    sh_log(shown, SH_ERROR, "%s: the state contains values that this FMU never saves.", function);
    return 0;
}
