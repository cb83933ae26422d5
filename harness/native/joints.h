/* Estimators for arrays of samples, without an FMU. The caller owns all memory.
 *
 * The number of a variable is its value reference in StiffnessEstimator.fmu.
 */
#ifndef SH_JOINTS_H
#define SH_JOINTS_H

#include <stddef.h>

#include "estimator_fmu.h"
#include "export.h"

/* One estimator: parameters, state, last outputs. A copy of the struct is a copy of the estimator. */
typedef sh_estimator_fmu sh_joint;

/* Where an output goes. */
typedef struct {
    unsigned variable; /* a Real output; an Integer or Boolean one */
    void *values;      /* double; int [size: joints x samples] */
} sh_joint_output;

/* GUID of the model description with these numbers of variables. */
SH_EXPORT const char *sh_joint_guid(void);

/* Size of sh_joint [bytes]. */
SH_EXPORT size_t sh_joint_size(void);

/* Place of a variable in sh_joint [bytes]. */
SH_EXPORT size_t sh_joint_place(unsigned variable);

/* Sets every variable to its start value, which may depend on samplePeriod [s]. */
SH_EXPORT void sh_joint_default(sh_joint *joint, double samplePeriod);

/* Sets a parameter, of any type. */
SH_EXPORT void sh_joint_set(sh_joint *joint, unsigned variable, double value);

/* Returns 1 if a parameter is out of its range, which `violation` then describes; else 0. */
SH_EXPORT int sh_joint_check(const sh_joint *joint, sh_violation *violation);

/* Starts the estimator with its parameters, which pass the check. */
SH_EXPORT void sh_joint_start(sh_joint *joint);

/* Evaluates torque and stiffness at `count` deformations phi [rad] and set-points, by the present
 * estimate [size: count]. Nothing is learned.
 */
SH_EXPORT void sh_joint_evaluate(const sh_joint *joint, size_t count, const double *phi,
                                 const double *set_point, sh_point *points);

/* Gives the stiffness at `count` points and the quantities SH_QUANTITY_*, as sh_estimator_covariance. */
SH_EXPORT int sh_joint_covariance(const sh_joint *joint, size_t count, const double *phi,
                                  const double *set_point, double *values, double *per_gain,
                                  double *covariance);

/* Size of the saved bytes of so many estimators [bytes]. */
SH_EXPORT size_t sh_joints_saved_size(size_t joints);

/* Saves parameters, estimates and outputs.
 *
 * memory  of sh_joint, at memory + j * stride for joint j [size: joints x stride, bytes]
 * saved   the bytes, for this build of the library on this platform [size: sh_joints_saved_size()]
 */
SH_EXPORT void sh_joints_save(const char *memory, size_t joints, size_t stride, void *saved);

/* Restores what sh_joints_save saved.
 *
 * memory  as for sh_joints_save
 * saved   any bytes, for example of a file [size: size]
 *
 * Returns NULL, or the defect of the bytes as text, such as "is truncated": then the memory is
 * unchanged. Bytes without a defect have parameters in their ranges, and estimators with which a
 * tick is possible, even if the bytes are a forgery with the right checksum.
 */
SH_EXPORT const char *sh_joints_restore(char *memory, size_t joints, size_t stride,
                                        const void *saved, size_t size);

/* Runs a tick for each of the samples first to end - 1 of each joint, joint after joint.
 *
 * memory  of sh_joint, at memory + j * stride for joint j [size: joints x stride, bytes]
 * theta, q, theta_c, tau, tau_e_sensor  samples [size: joints x samples]; NULL: all 0
 * outputs [size: count]
 */
SH_EXPORT void sh_joints_run(char *memory, size_t joints, size_t stride, size_t samples,
                             size_t first, size_t end, const double *theta, const double *q,
                             const double *theta_c, const double *tau, const double *tau_e_sensor,
                             const sh_joint_output *outputs, size_t count);

#endif
