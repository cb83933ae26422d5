/* The block of bytes that a saved state is: a header, then the model's struct. It contains no pointer.
 *
 * Serialised, it is the same bytes; version, GUID, length and checksum show whether they are damaged
 * or of another FMU.
 */
#ifndef SH_STATE_BLOCK_H
#define SH_STATE_BLOCK_H

#include "instance.h"

size_t sh_block_size(void);

/* Writes the state of an instance to a block, without its checksum. */
void sh_block_write(const sh_instance *instance, void *block);

/* NULL if the block is a state of this FMU, else what is wrong with it. Only its header is read. */
const char *sh_block_defect(const void *block);

/* Takes the state in a block without a defect. */
void sh_block_read(sh_instance *instance, const void *block);

/* Adds the checksum to a block that leaves this FMU. */
void sh_block_sign(void *block);

/* NULL if the bytes are a block without a defect, with its checksum; else what is wrong with them: "is
 * truncated".
 */
const char *sh_bytes_defect(const void *bytes, size_t size);

/* Whether an instance can go on from a block that came from outside: 1, or 0 after a message. A
 * checksum does not show whether somebody made the bytes on purpose.
 */
int sh_block_is_sound(const sh_instance *instance, void *block, const char *function);

#endif
