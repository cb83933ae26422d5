/* Simulator of a joint: a motor behind a gear, a spring, a link, and the misfits of real joints.
 *
 *     (gain) tau = B gamma theta'' + friction + cogging - tau_e / gamma        motor axis
 *     M q'' = tau_ext - D_q q' - mgl sin q - contact - tau_e                   link
 *
 * Solved by Runge-Kutta 4. Every departure from the model of the estimator is a parameter that is
 * 0 (or 1 for factors) where there is none. Angles are those behind the gear.
 */
#ifndef SIM_H
#define SIM_H

#include <stdint.h>

enum { SIM_SINES = 6 };

/* Sum of sines. */
typedef struct {
    int count;
    double amplitude[SIM_SINES], omega[SIM_SINES], phase[SIM_SINES]; /* [unit, rad/s, rad] */
} sim_multisine;

typedef struct {
    /* motor and link */
    double B, D, gamma;          /* [kg.m2, N.m.s/rad, 1] */
    double tau_coulomb;          /* [N.m] on the motor axis */
    double v_coulomb;            /* friction is tanh(theta' / v_coulomb) [rad/s] */
    double M, D_q, mgl;          /* link [kg.m2, N.m.s/rad, N.m] */
    double load;                 /* constant torque on the link [N.m] */
    double contact_k, contact_d; /* spring and damper between link and world */
    /* spring: tau_e = k x + k3 x^3 behind the dead zone, or the AwAS if k_s > 0 */
    double k, k3;          /* [N.m/rad, N.m/rad3] */
    double k_s;            /* [N/m]; tau_e = k_s r^2 sin 2x */
    double gap;            /* half width of the dead zone [rad] */
    double damping;        /* [s]: tau_e gains damping times sigma times x' */
    double dahl, dahl_phi; /* hysteresis: torque [N.m] and deformation [rad] of the Dahl model */
    double kin_error, kin_order; /* kinematic error of the gear [rad], per turn of the motor */
    /* friction and torque of the motor */
    double uneven;               /* Coulomb friction (sign + uneven) [1] */
    double load_friction;        /* friction per torque of the spring [1] */
    double stribeck, v_stribeck; /* friction grows by this factor - 1 [1] at rest; [rad/s] */
    double v_cubic;          /* viscous friction D v / sqrt(1 + (v/v_cubic)^2); 0: linear [rad/s] */
    double D_drift, C_drift; /* relative change of D, of Coulomb friction, over drift_time [1] */
    double drift_time;       /* [s] */
    double k_drift;          /* relative change of the spring over the same time [1] */
    double ripple, ripple_order; /* cogging [N.m], per turn of the motor */
    double gain, bias; /* measured torque: tau = (tau_true - bias) / gain; gain 1, bias [N.m] */
    double late;       /* delay of the measured torque [s] */
    int hold;          /* 0: torque is continuous; 1: held, u(k) given; 2: held, mean given */
    /* sensors */
    double counts_theta, counts_q;       /* counts per turn (behind the gear); 0: no rounding */
    double eccentric_q, eccentric_theta; /* [rad], once per turn of the link, of the motor; behind
                                            the gear */
    double zero;                         /* zero of the deformation [rad] */
    double skew;                         /* q is read so much later than theta [s] */
    double jitter;                       /* std deviation of the sample times [s] */
    double noise_tau, noise_sensor;      /* std deviations [N.m] */
    double T;                            /* sample period [s] */
    int substeps;                        /* of Runge-Kutta in a sample */
    /* command */
    sim_multisine torque; /* open loop, or feed-forward [N.m] */
    double rest;          /* no torque before [s] */
    double on, off;       /* misfits act between [s], see acts() in sim.c; off = 0: always */
    sim_multisine arm;    /* lever arm less r_0 [m], AwAS */
    double r_0;
    double kp, kd, kq; /* control of the measured motor position by torque [N.m/rad, N.m.s/rad];
                            kq: damping by the link velocity */
    sim_multisine reference; /* of the position [rad] */
    double reference_0;      /* its mean [rad] */
    uint64_t seed;
} sim_parameters;

typedef struct {
    double x[5];                      /* q, q', theta, theta', z of the Dahl model */
    double t;                         /* time of the state [s] */
    double u[2];                      /* torque held now and before [N.m] */
    double theta_0, q_0, velocity[2]; /* measured before, for control */
    int64_t tick;
    uint64_t random;
    double spare; /* second number of a pair of Gaussians */
    int has_spare;
    const sim_parameters *p;
} sim;

typedef struct {
    double theta, q, r, tau, sensor; /* measured */
    double sigma, phi, tau_e;        /* true */
    int in_gap;                      /* 1: the spring is in its dead zone, sigma = 0 */
} sim_sample;

void sim_start(sim *s, const sim_parameters *p);

/* The next sample; the first is that of t = 0. */
void sim_next(sim *s, sim_sample *out);

double sim_gauss(uint64_t *state);
double sim_uniform(uint64_t *state);
double sim_sum(const sim_multisine *m, double t);

#endif
