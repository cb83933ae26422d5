/* The shape of a method of estimation, and what all methods share.
 *
 * A method has a folder of its own and defines one constant of type sh_method. To add a method,
 * write its folder and add its line to SH_METHODS in sigmahat.h. Nothing else in c/ and fmu_src/ asks
 * which methods there are. If the method has its own state, add a struct to sigmahat_state.h.
 *
 * All of c/ can be compiled as one file (the amalgamation). So all its files share one namespace
 * for the names that are `static`: two files must not use the same one.
 */
#ifndef SH_METHOD_H
#define SH_METHOD_H

#include "sigmahat.h"

/* The value of a macro as a string. */
#define SH_TEXT(token) #token
#define SH_TEXT_OF(macro) SH_TEXT(macro)

typedef struct {
    /* Largest deformation that the parameters allow [rad]; may be infinite. */
    sh_real (*largest_deformation)(const sh_parameters *p);

    /* Checks the conditions that only this method sets. Each parameter is in its range. Returns 0,
     * or 1 after sh_violates.
     */
    int (*check)(const sh_parameters *p, sh_violation *violation);

    /* Starts the state of the method in an estimator that is zero. Sets in estimate, which is zero
     * but for the curve: the uncertainty of the curve rls.eta_0 at phi = 0 and the set-point at
     * theta_c = 0, the motor data, misfit and doubt.
     */
    void (*start)(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate);

    /* Takes one sample, which is finite.
     *
     * estimate  in: that of the last tick; out: everything but setPoint, confident and valid
     *
     * Returns 1. Returns 0 if the numbers are too large: then estimate is unchanged. The filters of Paper2011 do not
     * change. The filters of FilteredRegression start again as after a gap, but changes of its regression by this
     * sample stay.
     */
    int (*tick)(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                sh_real set_point, sh_estimate *estimate);

    /* Torque and stiffness at a deformation [rad] and a set-point [1] by the present estimate. */
    void (*evaluate)(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                     sh_real set_point, sh_point *point);
} sh_method;

/* Besides the constant each method has a function that checks a state that comes from elsewhere, as
 * sh_estimator_check. The function is not a member of the constant, and stands in a file of its own.
 * So a program that calls no check does not contain the function.
 *
 * Returns 0, or 1 if sizes, places and choices in it are not those of a state of the method.
 */
#define SH_METHOD_DECLARATION(constant, number, name, block)                                       \
    extern const sh_method block;                                                                  \
    int block##_check_state(const sh_estimator *estimator, const sh_parameters *p);
SH_METHODS(SH_METHOD_DECLARATION)

/* The method that the parameters choose, NULL if there is none of this number. */
const sh_method *sh_method_of(const sh_parameters *p);

/* Describes a violation. Returns 1. */
int sh_violates(sh_violation *violation, const char *name, sh_real value, const char *range);

/* Resolution of an encoder [rad], 0 without quantisation. */
sh_real sh_encoder_count(sh_real counts_per_turn);

/* The flexibility torque that the regression uses [N.m]. The modality chooses between the torque of the
 * sensor, the torque of the model at the measured positions, and from_motor.
 */
sh_real sh_regression_torque(const sh_parameters *p, const sh_measurement *z, sh_real from_motor);

#endif
