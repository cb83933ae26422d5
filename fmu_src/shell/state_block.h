/* A saved state is a block of bytes: a header, then the model's struct. It contains no pointer.
 *
 * A serialised state is the same bytes. Version, GUID, length and checksum show whether the bytes
 * are damaged or of another FMU.
 */
#ifndef SH_STATE_BLOCK_H
#define SH_STATE_BLOCK_H

#include "instance.h"

size_t sh_block_size(void);

/* Writes the state of an instance to a block, without its checksum. */
void sh_block_write(const sh_instance *instance, void *block);

/* NULL if the block is a state of this FMU, else the defect as text. Reads only the header. */
const char *sh_block_defect(const void *block);

/* Copies the state from a block without a defect to the instance. */
void sh_block_read(sh_instance *instance, const void *block);

/* Adds the checksum to a block that leaves this FMU. */
void sh_block_sign(void *block);

/* NULL if the bytes are a block without a defect, with its checksum; else the defect as text, such
 * as "is truncated".
 */
const char *sh_bytes_defect(const void *bytes, size_t size);

/* 1 if an instance can continue from a block from outside; else 0, after a message. A checksum does
 * not show whether somebody made the bytes on purpose.
 */
int sh_block_is_sound(const sh_instance *instance, void *block, const char *function);

#endif
