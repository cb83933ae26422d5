#include "catalogue.h"

#include <math.h>
#include <string.h>

#define PI 3.141592653589793

enum {
    NONE,
    GAIN,
    BIAS,
    RIPPLE6,
    RIPPLE12,
    STRIBECK,
    UNEVEN,
    LOADFRICTION,
    VISCOUS_DRIFT,
    CUBIC,
    LATE,
    ZOH,
    ZOH_MEAN,
    JITTER,
    ECC_Q,
    ECC_M,
    ZERO,
    BACKLASH,
    KINEMATIC,
    DAHL,
    DAMPING,
    CONTACT,
    ENCODERS,
    RATE,
    SMALL_N,
    SMALL_M,
    HARDENING,
    PD,
    PD_Q,
    PD_GRAVITY,
    LOAD,
    REST,
    COULOMB_DRIFT,
    B_WRONG,
    SKEW,
    RANDOM,
    RANDOM_CLEAN
};

/* second: 1, 4: B exact and prior.B = 0; 2, 3, 4: the prior of the gain */
const cat_condition CAT_CONDITIONS[] = {
    {"none", NONE, CLASS_CLEAN, 0, 0},
    {"500 Hz", RATE, CLASS_CLEAN, 2e-3, 0},
    {"5 kHz", RATE, CLASS_CLEAN, 2e-4, 0},
    {"contact", CONTACT, CLASS_CLEAN, 0, 0},
    {"PD on motor (ZOH mean)", PD, CLASS_CLEAN, 0, 0},
    {"PD + feedback of q", PD_Q, CLASS_CLEAN, 0, 0},
    {"PD + gravity, one sign of phi", PD_GRAVITY, CLASS_CLEAN, 0, 0},
    {"constant load, one sign of phi", LOAD, CLASS_CLEAN, 0, 0},
    {"bias 2 %", BIAS, CLASS_1, 0.02, 0},
    {"uneven Coulomb 20 %", UNEVEN, CLASS_1, 0.2, 0},
    {"load friction 0.1", LOADFRICTION, CLASS_1, 0.1, 0},
    {"load friction 0.2", LOADFRICTION, CLASS_1, 0.2, 0},
    {"eccentric q 0.31 mrad", ECC_Q, CLASS_1, 0.31e-3, 0},
    {"eccentric q 0.87 mrad", ECC_Q, CLASS_1, 0.87e-3, 0},
    {"zero 0.2 mrad", ZERO, CLASS_1, 0.2e-3, 0},
    {"late 1 ms", LATE, CLASS_1, 1e-3, 0},
    {"late 2 ms", LATE, CLASS_1, 2e-3, 0},
    {"damping k/300", DAMPING, CLASS_1, 1.0 / 300, 0},
    {"damping k/1000", DAMPING, CLASS_1, 1.0 / 1000, 0},
    {"jitter 5 %", JITTER, CLASS_1, 0.05, 0},
    {"zero 2 mrad", ZERO, CLASS_2, 2e-3, 0},
    {"Dahl 2 %", DAHL, CLASS_2, 0.02, 0},
    {"Dahl 5 %", DAHL, CLASS_2, 0.05, 0},
    {"backlash 1 mrad", BACKLASH, CLASS_2, 1e-3, 0},
    {"n = 1 (too small)", SMALL_N, CLASS_2, 1, 0},
    {"m = 2 (too small)", SMALL_M, CLASS_2, 2, 0},
    {"hardening, n = 1", HARDENING, CLASS_2, 1, 0},
    {"eccentric motor 0.031 mrad", ECC_M, CLASS_2, 0.031e-3, 0},
    {"eccentric motor 0.087 mrad", ECC_M, CLASS_2, 0.087e-3, 0},
    {"ripple 6/rev 2 %", RIPPLE6, CLASS_3, 0.02, 0},
    {"ripple 6/rev 5 %", RIPPLE6, CLASS_3, 0.05, 0},
    {"ripple 12/rev 2 %", RIPPLE12, CLASS_3, 0.02, 0},
    {"ripple 12/rev 5 %", RIPPLE12, CLASS_3, 0.05, 0},
    {"Stribeck 1.5x", STRIBECK, CLASS_3, 0.5, 0},
    {"viscous -30 % in 60 s", VISCOUS_DRIFT, CLASS_3, -0.3, 0},
    {"Coulomb -30 % in 60 s", COULOMB_DRIFT, CLASS_3, -0.3, 0},
    {"gain 0.98", GAIN, CLASS_GAIN, 0.98, 0},
    {"gain 1.025", GAIN, CLASS_GAIN, 1.025, 0},
    {"gain 0.95, prior 0.05", GAIN, CLASS_GAIN, 0.95, 2},
    {"gain 1.05, prior 0.05", GAIN, CLASS_GAIN, 1.05, 2},
    {"gain 0.90, prior 0.10", GAIN, CLASS_GAIN, 0.90, 3},
    {"gain 1.10, prior 0.10", GAIN, CLASS_GAIN, 1.10, 3},
    {"gain 0.90, B exact, prior 0.10", GAIN, CLASS_GAIN, 0.90, 4},
    {"cubic viscous", CUBIC, CLASS_NONE, 4, 0},
    {"late 5 ms", LATE, CLASS_NONE, 5e-3, 0},
    {"ZOH, u(k)", ZOH, CLASS_NONE, 0, 0},
    {"ZOH, mean of u", ZOH_MEAN, CLASS_NONE, 0, 0},
    {"kinematic 0.3 mrad 2/rev", KINEMATIC, CLASS_NONE, 0.3e-3, 0},
    {"kinematic 0.1 mrad 2/rev", KINEMATIC, CLASS_NONE, 0.1e-3, 0},
    {"Dahl 10 %", DAHL, CLASS_NONE, 0.1, 0},
    {"damping k/100", DAMPING, CLASS_NONE, 0.01, 0},
    {"encoders 4096", ENCODERS, CLASS_NONE, 4096, 0},
    {"encoders 65536", ENCODERS, CLASS_NONE, 65536, 0},
    {"encoders 1048576", ENCODERS, CLASS_NONE, 1048576, 0},
    {"encoders read 2 ms apart", SKEW, CLASS_NONE, 2e-3, 0},
    {"hardening, n = 3", HARDENING, CLASS_NONE, 3, 0},
    {"rest 30 s, then 10 s", REST, CLASS_NONE, 0, 0},
    {"B exact: none", NONE, CLASS_NONE, 0, 1},
    {"B exact: load friction 0.1", LOADFRICTION, CLASS_NONE, 0.1, 1},
    {"B exact: Dahl 5 %", DAHL, CLASS_NONE, 0.05, 1},
    {"B exact: damping k/300", DAMPING, CLASS_NONE, 1.0 / 300, 1},
    {"B exact: eccentric q 0.31 mrad", ECC_Q, CLASS_NONE, 0.31e-3, 1},
    {"B exact: zero 0.2 mrad", ZERO, CLASS_NONE, 0.2e-3, 1},
    {"B exact: jitter 5 %", JITTER, CLASS_NONE, 0.05, 1},
    {"B exact: late 2 ms", LATE, CLASS_NONE, 2e-3, 1},
    {"B +5 % wrong, prior 0", B_WRONG, CLASS_NONE, 0.05, 1},
    {"random, all at once", RANDOM, CLASS_RANDOM, 0, 0},
    {"random, clean", RANDOM_CLEAN, CLASS_NONE, 0, 0},
};
const int CAT_COUNT = sizeof CAT_CONDITIONS / sizeof CAT_CONDITIONS[0];
const char *const CAT_JOINTS[] = {"AwAS", "SEA1k", "SEA5k"};

static void multisine(sim_multisine *m, uint64_t *r, double low, double high, double amplitude,
                      int least, int most)
{
    double sum = 0;
    int i;

    m->count = least + (int)(sim_uniform(r) * (most - least + 1));
    for (i = 0; i < m->count; ++i) {
        m->omega[i] = 2 * PI * exp(log(low) + (i + sim_uniform(r)) / m->count * log(high / low));
        m->phase[i] = 2 * PI * sim_uniform(r);
        m->amplitude[i] = 0.3 + 0.7 * sim_uniform(r);
        sum += m->amplitude[i];
    }
    for (i = 0; i < m->count; ++i) {
        m->amplitude[i] *= amplitude / sum;
    }
}

static double peak_deformation(int joint)
{
    return joint == AWAS ? 0.05 : joint == SEA1K ? 0.012 : 0.0024;
}

static void make_joint(int joint, sim_parameters *p, cat_given *given, uint64_t *r)
{
    const double peak = joint == AWAS ? 0.4 : 0.35;

    memset(p, 0, sizeof *p);
    p->gain = 1;
    p->v_coulomb = 0.02;
    p->v_stribeck = 0.1;
    p->T = 1e-3;
    p->substeps = 4;
    p->noise_tau = sqrt(1e-5);
    p->noise_sensor = sqrt(1e-3);
    multisine(&p->torque, r, 0.1, 10, peak, 3, 6);
    if (joint == AWAS) {
        p->B = 2.3e-5;
        p->D = 1e-3;
        p->gamma = 50;
        p->tau_coulomb = 0.02;
        p->M = 0.1;
        p->D_q = 0.15;
        p->k_s = 14220;
        p->r_0 = 0.07;
        multisine(&p->arm, r, 0.05, 0.5, 0.012, 1, 3);
        p->counts_theta = p->counts_q = 40000;
        given->n = given->m = 3;
        given->range_phi = 0.3;
        given->prior_tau_e = 45;
    } else {
        p->B = 1e-4;
        p->D = 5e-4;
        p->gamma = 100;
        p->tau_coulomb = 0.03;
        p->M = 0.5;
        p->D_q = 0.1;
        p->k = joint == SEA1K ? 1000 : 5000;
        p->counts_theta = p->counts_q = joint == SEA1K ? 40000 : 262144;
        given->n = given->m = 1;
        given->range_phi = joint == SEA1K ? 0.03 : 0.006;
        given->prior_tau_e = 45;
    }
    given->prior_D = 0.2;
    given->prior_B = 0.1;
    given->prior_coulomb = p->tau_coulomb;
    given->torque_gain = 0;
    given->noise_tau = 3.2e-3;
}

/* Largest deformation in a run without hysteresis [rad]. */
static double peak_of(const sim_parameters *p, double duration)
{
    sim_parameters q = *p;
    sim_sample z;
    sim s;
    double peak = 0;
    int k;

    q.substeps = 2;
    q.dahl = 0;
    sim_start(&s, &q);
    for (k = 0; k * q.T < duration; ++k) {
        sim_next(&s, &z);
        peak = fmax(peak, fabs(z.phi));
    }
    return peak;
}

static void make_random(int joint, sim_parameters *p, cat_given *given, uint64_t *r, int clean)
{
    const double f = exp(0.3 * sim_gauss(r)), peak = joint == AWAS ? 0.4 : 0.35;
    double span;

    p->B *= exp(0.25 * sim_gauss(r));
    p->D *= exp(0.4 * sim_gauss(r));
    p->M *= exp(0.3 * sim_gauss(r));
    p->tau_coulomb *= sim_uniform(r) * 2;
    if (joint == AWAS) {
        p->k_s *= f;
    } else {
        p->k *= f;
        p->k3 = 0;
    }
    if (clean) {
        return;
    }
    span = peak_of(p, 20);
    p->gain = 1 + 0.02 * sim_gauss(r);
    p->bias = 0.01 * peak * sim_gauss(r);
    p->uneven = 0.1 * sim_gauss(r);
    p->load_friction = 0.1 * sim_uniform(r);
    p->ripple = 0.01 * peak * sim_uniform(r);
    p->ripple_order = sim_uniform(r) < 0.5 ? 6 : 12;
    p->stribeck = 0.3 * sim_uniform(r);
    p->late = 1e-3 * sim_gauss(r);
    p->jitter = 0.01 * p->T * sim_uniform(r);
    p->eccentric_q = 0.2e-3 * sim_uniform(r);
    p->eccentric_theta = 0.02e-3 * sim_uniform(r);
    p->zero = 0.2e-3 * sim_gauss(r);
    p->dahl = 0.03 * sim_uniform(r) * (joint == AWAS ? 2 * p->k_s * p->r_0 * p->r_0 : p->k) * span;
    p->dahl_phi = 0.03 * span;
    p->damping = 1.0 / 500 * sim_uniform(r);
    p->kin_error = 0.05e-3 * sim_uniform(r);
    p->kin_order = 2;
    p->gap = joint == SEA5K ? 0.02e-3 * sim_uniform(r) : 0.1e-3 * sim_uniform(r);
    p->D_drift = 0.1 * sim_gauss(r);
    p->drift_time = 60;
    given->torque_gain = 0.02;
}

/* Conditions of the spring. Returns 0 if the joint has no such condition. */
static int make_spring(int joint, const cat_condition *c, double duration, sim_parameters *p,
                       cat_given *given)
{
    double span = peak_deformation(joint);

    switch (c->id) {
    case BACKLASH:
        p->gap = c->value / 2;
        break;
    case KINEMATIC:
        if (joint == AWAS && c->value < 0.2e-3) {
            return 0;
        }
        p->kin_error = c->value;
        p->kin_order = 2;
        break;
    case DAHL:
        span = peak_of(p, duration);
        p->dahl = c->value * (joint == AWAS ? 2 * p->k_s * p->r_0 * p->r_0 : p->k) * span;
        p->dahl_phi = 0.03 * span;
        break;
    case DAMPING:
        p->damping = c->value;
        break;
    case SMALL_N:
    case SMALL_M:
        if (joint != AWAS) {
            return 0;
        }
        *(c->id == SMALL_N ? &given->n : &given->m) = (int)c->value;
        break;
    case HARDENING:
        if (joint == AWAS) {
            return 0;
        }
        p->k3 = 0.3 * p->k / (3 * span * span);
        given->n = (int)c->value;
        break;
    default:
        break;
    }
    return 1;
}

/* Conditions of the motor and of the measured torque. Returns 0 if the joint has no such condition.
 */
static int make_motor(int joint, const cat_condition *c, double peak, sim_parameters *p,
                      cat_given *given)
{
    switch (c->id) {
    case GAIN:
        p->gain = c->value;
        given->torque_gain = c->second == 2 ? 0.05 : c->second >= 3 ? 0.1 : 0.02;
        break;
    case BIAS:
        p->bias = c->value * peak;
        break;
    case RIPPLE6:
    case RIPPLE12:
        p->ripple = c->value * peak;
        p->ripple_order = c->id == RIPPLE6 ? 6 : 12;
        break;
    case STRIBECK:
        p->stribeck = c->value;
        break;
    case UNEVEN:
        p->uneven = c->value;
        break;
    case LOADFRICTION:
        p->load_friction = c->value;
        break;
    case VISCOUS_DRIFT:
        p->D_drift = c->value;
        p->drift_time = 60;
        break;
    case COULOMB_DRIFT:
        p->C_drift = c->value;
        p->drift_time = 60;
        break;
    case CUBIC:
        if (joint == SEA5K) {
            return 0;
        }
        p->v_cubic = c->value;
        break;
    case LATE:
        p->late = c->value;
        break;
    case ZOH:
        p->hold = 1;
        break;
    case ZOH_MEAN:
        p->hold = 2;
        break;
    case B_WRONG:
        given->B = p->B * (1 + c->value);
        break;
    default:
        break;
    }
    return 1;
}

/* Conditions of the sensors. Returns 0 if the joint has no such condition. */
static int make_sensors(int joint, const cat_condition *c, sim_parameters *p)
{
    switch (c->id) {
    case JITTER:
        p->jitter = c->value * p->T;
        break;
    case ECC_Q:
        p->eccentric_q = c->value;
        break;
    case ECC_M:
        if (joint == SEA5K) {
            return 0;
        }
        p->eccentric_theta = c->value;
        break;
    case ZERO:
        p->zero = c->value;
        break;
    case SKEW:
        p->skew = c->value;
        break;
    case ENCODERS:
        p->counts_theta = p->counts_q = c->value;
        break;
    case RATE:
        p->T = c->value;
        p->substeps = p->T > 1.5e-3 ? 8 : p->T < 5e-4 ? 1 : 4;
        break;
    default:
        break;
    }
    return 1;
}

/* Control of the motor position. */
static void make_control(int joint, int id, double peak, sim_parameters *p)
{
    int i;

    p->hold = 2;
    p->reference = p->torque;
    p->torque.count = 0;
    for (i = 0; i < p->reference.count; ++i) { /* position in rad, smaller when faster */
        const double w = p->reference.omega[i];

        p->reference.amplitude[i] = p->reference.amplitude[i] / peak * 3 / (1 + w);
    }
    p->kp = joint == AWAS ? 2 : 15;
    p->kd = joint == AWAS ? 0.03 : 0.4;
    if (id == PD_Q) {
        p->kq = p->kd / 2;
    }
    if (id == PD_GRAVITY) {
        p->mgl = 12;
        p->reference_0 = PI / 2;
        for (i = 0; i < p->reference.count; ++i) {
            p->reference.amplitude[i] *= 0.6;
        }
    }
}

/* A constant load on the link, and the mean torque of the motor that carries it. */
static void make_load(int joint, sim_parameters *p)
{
    int i;

    p->load = joint == AWAS ? -8 : -10;
    for (i = 0; i < p->torque.count; ++i) {
        p->torque.amplitude[i] *= 0.9;
    }
    if (p->torque.count < SIM_SINES) {
        p->torque.count += 1;
    }
    i = p->torque.count - 1; /* if there are as many sines as there can be, it replaces the last */
    p->torque.amplitude[i] = -p->load / p->gamma;
    p->torque.omega[i] = 0;
    p->torque.phase[i] = PI / 2;
}

/* Conditions of the operation. Returns 0 if the joint has no such condition. */
static int make_operation(int joint, const cat_condition *c, double peak, sim_parameters *p)
{
    switch (c->id) {
    case CONTACT:
        p->contact_k = joint == AWAS ? 200 : 3000;
        p->contact_d = joint == AWAS ? 1 : 20;
        break;
    case PD:
    case PD_Q:
    case PD_GRAVITY:
        if (c->id == PD_GRAVITY && joint == AWAS) {
            return 0;
        }
        make_control(joint, c->id, peak, p);
        break;
    case LOAD:
        make_load(joint, p);
        break;
    case REST:
        p->rest = 30;
        break;
    default:
        break;
    }
    return 1;
}

static double duration_of(int id)
{
    return id == VISCOUS_DRIFT || id == COULOMB_DRIFT ? 60 : id == REST ? 40 : 20;
}

double cat_make(int joint, const cat_condition *c, uint64_t seed, sim_parameters *p,
                cat_given *given)
{
    const double duration = duration_of(c->id), peak = joint == AWAS ? 0.4 : 0.35;
    uint64_t random = seed * 1000003ULL + (uint64_t)joint * 7777ULL;
    int i;

    for (i = 0; i < 4; ++i) {
        sim_uniform(&random);
    }
    make_joint(joint, p, given, &random);
    p->seed = seed + 100 * (uint64_t)joint;
    if (c->id == RANDOM || c->id == RANDOM_CLEAN) {
        make_random(joint, p, given, &random, c->id == RANDOM_CLEAN);
    }
    given->D = p->D * (sim_uniform(&random) < 0.5 ? 1.1 : 0.9);
    given->B = p->B * (sim_uniform(&random) < 0.5 ? 1.05 : 0.95);
    if (c->second == 1 || c->second == 4) {
        given->B = p->B;
        given->prior_B = 0;
    }
    return make_spring(joint, c, duration, p, given) && make_motor(joint, c, peak, p, given) &&
                   make_sensors(joint, c, p) && make_operation(joint, c, peak, p)
               ? duration
               : 0;
}
