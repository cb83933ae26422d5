/* What all saved states of this project have in common: states of FMUs (shell/saved_state.c) and of the estimators of
 * the Python package (harness/native/saved_joints.c).
 */
#ifndef SH_SAVED_BYTES_H
#define SH_SAVED_BYTES_H

#include <stddef.h>
#include <stdint.h>

/* Raise the version if a model's struct changes: the GUID may not change. */
enum { SH_STATE_VERSION = 26 };

/* Checksum of a block of bytes, as if the checksum in the block, at the place `hole` [bytes], were 0. FNV-1a, 64 bit:
 * datatracker.ietf.org/doc/html/draft-eastlake-fnv
 */
static inline uint64_t sh_checksum(const unsigned char *block, size_t size, size_t hole)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    size_t i;

    for (i = 0; i < size; ++i) {
        const unsigned char byte = i >= hole && i < hole + sizeof hash ? 0 : block[i];
        hash = (hash ^ byte) * UINT64_C(1099511628211);
    }
    return hash;
}

#endif
