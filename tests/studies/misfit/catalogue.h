/* The catalogue of misfits: joints, conditions, and the settings that an estimator is given. */
#ifndef CATALOGUE_H
#define CATALOGUE_H

#include "sim.h"

enum { AWAS, SEA1K, SEA5K, JOINTS };

enum { CLASS_NONE, CLASS_CLEAN, CLASS_1, CLASS_2, CLASS_3, CLASS_GAIN, CLASS_RANDOM, CLASSES };

/* Settings that an estimator is given for a run. */
typedef struct {
    double B, D, prior_B, prior_D, prior_coulomb, prior_tau_e, range_phi, torque_gain;
    double noise_tau;
    int n, m;
} cat_given;

typedef struct {
    const char *name;
    int id, class_;
    double value, second;
} cat_condition;

extern const cat_condition CAT_CONDITIONS[];
extern const int CAT_COUNT;
extern const char *const CAT_JOINTS[];

/* Parameters of a run; returns its duration [s], or 0 if the joint has no such condition. */
double cat_make(int joint, const cat_condition *c, uint64_t seed, sim_parameters *p,
                cat_given *given);

#endif
