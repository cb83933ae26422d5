/* The block of bytes that a saved state is: a header, then the model's struct. It contains no pointer.
 *
 * Serialised, it is the same bytes; version, GUID, length and checksum show whether a block is
 * damaged or of another FMU. They do not show whether it was made on purpose: what is in it is
 * checked before an instance takes it.
 */
#ifndef SH_STATE_BLOCK_H
#define SH_STATE_BLOCK_H

#include "instance.h"

size_t sh_block_size(void);

/* NULL if the bytes are a state of this FMU, else what is wrong with them: "is truncated". */
const char *sh_block_defect(const void *bytes, size_t size);

/* Writes the state of an instance to a block. */
void sh_block_write(const sh_instance *instance, void *block);

/* Shows the state in a block without a defect as an instance: with the importer and the name of this
 * one, and the model in the block.
 */
sh_instance sh_block_instance(const sh_instance *instance, void *block);

/* 1 if an instance can go on from what is shown of a block; else 0, after a message. */
int sh_block_is_sound(sh_instance *shown, const char *function);

#endif
