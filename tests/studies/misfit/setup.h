/* The settings of both estimators for a joint of the simulator, and the set-point of the AwAS. */
#ifndef SETUP_H
#define SETUP_H

#include "catalogue.h"
#include "est.h"
#include "sigmahat.h"

/* Position of the secondary motor of the AwAS, as its encoder measures it, for a lever arm r [m].
 * 0 for a joint without a lever arm. [rad]
 */
double setup_theta_c(const sim_parameters *p, double r);

/* Set-point for a position of the secondary motor [rad]: lever arm in mm. */
double setup_set_point(double theta_c);

/* Settings of the prototype for a joint of the catalogue. */
void setup_settings(const sim_parameters *p, const cat_given *given, est_settings *s);

/* Switches off the columns that a trial can switch on. */
void setup_without_candidates(est_settings *s);

/* Switches off the columns that are always on and that MatchedFilter does not have. */
void setup_without_new_columns(est_settings *s);

/* Parameters of MatchedFilter for a joint of the catalogue. The bandwidth is limited as in the
 * prototype.
 */
void setup_parameters(const sim_parameters *p, const cat_given *given, sh_parameters *q);

/* Runs a tick of MatchedFilter with a sample. */
void setup_tick(sh_estimator *estimator, const sh_parameters *q, const sim_sample *z,
                double theta_c, sh_estimate *estimate);

/* An AwAS whose motor torque is one sine of f [Hz] and A [N.m], and whose lever arm moves slowly.
 */
void setup_sine(sim_parameters *p, double f, double A, double coulomb, uint64_t seed);

#endif
