/* The parameters of the estimator for a joint of the simulator. */
#ifndef SETUP_H
#define SETUP_H

#include "catalogue.h"
#include "sigmahat.h"

/* Position of the secondary motor of the AwAS, as its encoder measures it, for a lever arm r [m].
 * 0 for a joint without a lever arm. [rad]
 */
double setup_theta_c(const sim_parameters *p, double r);

/* Switches off the columns that a trial can switch on. */
void setup_without_candidates(sh_parameters *q);

/* Switches off the columns that are always on, but for those of the torque and the motor data. */
void setup_without_new_columns(sh_parameters *q);

/* Parameters of FilteredRegression for a joint of the catalogue. */
void setup_parameters(const sim_parameters *p, const cat_given *given, sh_parameters *q);

/* Runs a tick with a sample. */
void setup_tick(sh_estimator *estimator, const sh_parameters *q, const sim_sample *z,
                double theta_c, sh_estimate *estimate);

/* An AwAS whose motor torque is one sine of f [Hz] and A [N.m], and whose lever arm moves slowly.
 */
void setup_sine(sim_parameters *p, double f, double A, double coulomb, uint64_t seed);

#endif
