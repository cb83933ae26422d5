/* Saving, restoring and serialising the state of the FMU, the same in every version of FMI. */
#include "saved_state.h"

#include <string.h>

#include "state_block.h"

sh_status sh_save_state(void *handle, void **state, const char *function)
{
    sh_instance *instance = sh_enter(handle, SH_ANY, function);
    void *block;

    if (instance == NULL || !sh_has(instance, state, function, "FMUState")) {
        return SH_ERROR;
    }
    /* The importer may pass a state from an earlier call, to be overwritten. */
    block = *state != NULL ? *state : sh_allocate(&instance->importer, sh_block_size());
    if (block == NULL) {
        sh_report(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    sh_block_write(instance, block);
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
    what = sh_block_defect(state);
    if (what != NULL) {
        sh_report(instance, SH_ERROR, "%s: the state %s.", function, what);
        return SH_ERROR;
    }
    sh_block_read(instance, state);
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
    *size = sh_block_size();
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
    if (size < sh_block_size()) {
        sh_report(instance, SH_ERROR, "%s: size = %lu bytes; expected %lu.", function,
                  (unsigned long)size, (unsigned long)sh_block_size());
        return SH_ERROR;
    }
    (void)memcpy(bytes, state, sh_block_size());
    sh_block_sign(bytes);
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
    what = sh_bytes_defect(bytes, size);
    if (what != NULL) {
        sh_report(instance, SH_ERROR, "%s: the state (%lu bytes) %s.", function,
                  (unsigned long)size, what);
        return SH_ERROR;
    }
    block = sh_allocate(&instance->importer, sh_block_size());
    if (block == NULL) {
        sh_report(instance, SH_ERROR, "%s: out of memory.", function);
        return SH_ERROR;
    }
    (void)memcpy(block, bytes, sh_block_size());
    if (!sh_block_is_sound(instance, block, function)) {
        sh_release(&instance->importer, block);
        return SH_ERROR;
    }
    *state = block;
    return SH_OK;
}
