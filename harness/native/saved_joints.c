/* Saves and restores estimators, after a check of the bytes. */
#include <stdint.h>
#include <string.h>

#include "joints.h"
#include "saved_bytes.h"

enum { GUID_LENGTH = 64 };

/* Begin of the saved bytes; the estimators follow, one sh_joint after another. */
typedef struct {
    char magic[8];
    uint32_t version;
    uint32_t joints;
    char guid[GUID_LENGTH];
    uint64_t checksum; /* checksum of all bytes, computed with checksum = 0 */
} saved_header;

static const char MAGIC[8] = {'s', 'h', '_', 'j', 'o', 'i', 'n', 't'};

size_t sh_joints_saved_size(size_t joints)
{
    return sizeof(saved_header) + joints * sizeof(sh_joint);
}

static uint64_t checksum(const void *saved, size_t joints)
{
    return sh_checksum(saved, sh_joints_saved_size(joints), offsetof(saved_header, checksum));
}

static saved_header header_of(const void *saved)
{
    saved_header header;

    memcpy(&header, saved, sizeof header);
    return header;
}

/* Place of an estimator in the saved bytes. */
static size_t place_of(size_t joint)
{
    return sizeof(saved_header) + joint * sizeof(sh_joint);
}

void sh_joints_save(const char *memory, size_t joints, size_t stride, void *saved)
{
    saved_header header;
    size_t j;

    memset(&header, 0, sizeof header);
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.version = SH_STATE_VERSION;
    header.joints = (uint32_t)joints;
    strncpy(header.guid, sh_joint_guid(), GUID_LENGTH - 1);
    memcpy(saved, &header, sizeof header);
    for (j = 0; j < joints; ++j) {
        memcpy((char *)saved + place_of(j), memory + j * stride, sizeof(sh_joint));
    }
    header.checksum = checksum(saved, joints);
    memcpy(saved, &header, sizeof header);
}

/* Returns the defect of the header or of the size, or NULL. */
static const char *defect_of_bytes(const void *saved, size_t size, size_t joints)
{
    saved_header header;

    if (size < sizeof header) {
        return "is truncated";
    }
    header = header_of(saved);
    if (memcmp(header.magic, MAGIC, sizeof MAGIC) != 0) {
        return "is not the state of an Estimator";
    }
    if (header.version != SH_STATE_VERSION) {
        return "has another version of the format";
    }
    if (strncmp(header.guid, sh_joint_guid(), GUID_LENGTH) != 0) {
        return "is of another version of the estimator";
    }
    if (header.joints != joints) {
        return "is of another number of joints";
    }
    if (size != sh_joints_saved_size(joints)) {
        return "is truncated or too long";
    }
    if (header.checksum != checksum(saved, joints)) {
        return "is damaged: its checksum does not match";
    }
    return NULL;
}

/* Returns 1 if a tick is possible. The parameters come first: the check of the state uses them. */
static int is_sound(const sh_joint *joint)
{
    sh_violation violation;

    return sh_parameters_check(&joint->parameters, &violation) == 0 &&
           sh_estimator_check(&joint->estimator, &joint->parameters) == 0;
}

const char *sh_joints_restore(char *memory, size_t joints, size_t stride, const void *saved,
                              size_t size)
{
    const char *const defect = defect_of_bytes(saved, size, joints);
    sh_joint joint;
    size_t j;

    if (defect != NULL) {
        return defect;
    }
    for (j = 0; j < joints; ++j) {
        memcpy(&joint, (const char *)saved + place_of(j), sizeof joint);
        if (!is_sound(&joint)) {
            return "contains values that an Estimator never saves";
        }
    }
    for (j = 0; j < joints; ++j) {
        memcpy(memory + j * stride, (const char *)saved + place_of(j), sizeof joint);
    }
    return NULL;
}
