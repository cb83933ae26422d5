/* Functions that save, restore and serialise the state of the FMU. A function that fails returns SH_ERROR after a
 * message and changes nothing. The importer passes `handle`, which may be NULL.
 */
#ifndef SH_SAVED_STATE_H
#define SH_SAVED_STATE_H

#include "instance.h"

/* Writes the state to *state, or to new memory if *state is NULL. */
sh_status sh_save_state(void *handle, void **state, const char *function);
sh_status sh_restore_state(void *handle, void *state, const char *function);
sh_status sh_free_state(void *handle, void **state, const char *function);

/* Writes the number of bytes of a serialised state to *size. */
sh_status sh_state_size(void *handle, const void *state, size_t *size, const char *function);
sh_status sh_serialize_state(void *handle, const void *state, void *bytes, size_t size,
                             const char *function);
sh_status sh_deserialize_state(void *handle, const void *bytes, size_t size, void **state,
                               const char *function);

#endif
