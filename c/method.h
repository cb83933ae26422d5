/* Interface of a method of estimation, and functions that all methods share.
 *
 * A method has a folder of its own and defines one constant of type sh_method. To add a method, write its folder and
 * add its line to SH_METHODS in sigmahat.h. No other code in c/ and fmu_src/ depends on the list of methods. If the
 * method has its own state, add a struct to sigmahat_state.h.
 *
 * All files of c/ can be compiled as one file (the amalgamation). Two files of c/ must therefore not define the same
 * `static` name.
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

    /* Checks the conditions that only this method requires of the parameters. Each parameter is already in its range.
     * Returns 0, or 1 after sh_violates.
     */
    int (*check)(const sh_parameters *p, sh_violation *violation);

    /* Starts the state of the method in an estimator that is zero. On entry, estimate contains only the curve
     * rls.eta_0. The function adds the uncertainty at phi = 0 and theta_c = 0, motor data, misfit and doubt.
     */
    void (*start)(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate);

    /* Updates estimator and estimate with one sample, which is finite.
     *
     * estimate  in: that of the last tick; out: everything but setPoint, confident and valid
     *
     * Returns 1. Returns 0 if a number is too large. In this case, estimate is unchanged, and the filters of Paper2011
     * are unchanged, too. FilteredRegression starts its filters again as after a gap, but keeps the changes of its
     * regression by this sample. FilteredRegression also returns 0 for a sample that no joint can give. Then only doubt
     * and confident change, and the filters start again with the next good sample.
     */
    int (*tick)(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                sh_real set_point, sh_estimate *estimate);

    /* Sets torque and stiffness of the present estimate at a deformation [rad] and a set-point [1]. */
    void (*evaluate)(const sh_estimator *estimator, const sh_parameters *p, sh_real phi,
                     sh_real set_point, sh_point *point);
} sh_method;

/* Besides the constant, each method has a function that checks a state, for example one from a file; see
 * sh_estimator_check. The function is not a member of the constant, and has a file of its own. A program that calls no
 * check then does not contain the function.
 *
 * Returns 0, or 1 if sizes, indices and flags of the state are impossible for the method.
 */
#define SH_METHOD_DECLARATION(constant, number, name, block)                                       \
    extern const sh_method block;                                                                  \
    int block##_check_state(const sh_estimator *estimator, const sh_parameters *p);
SH_METHODS(SH_METHOD_DECLARATION)

/* Largest number of ticks that is counted; at 1 kHz, 11 days. */
#define SH_MOST_TICKS 1000000000

/* The method that the parameters choose, NULL if there is none of this number. */
const sh_method *sh_method_of(const sh_parameters *p);

/* Describes a violation. Returns 1. */
int sh_violates(sh_violation *violation, const char *name, sh_real value, const char *range);

/* Resolution of an encoder [rad], 0 without quantisation. */
sh_real sh_encoder_count(sh_real counts_per_turn);

/* Returns the flexibility torque that the regression uses [N.m]. The modality chooses the torque of the sensor, the
 * torque of the model at the measured positions, or from_motor.
 */
sh_real sh_regression_torque(const sh_parameters *p, const sh_measurement *z, sh_real from_motor);

#endif
