#include "sim.h"

#include <math.h>
#include <string.h>

#define TWO_PI 6.283185307179586

/* splitmix64 */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9E3779B97F4A7C15ULL);

    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
}

double sim_uniform(uint64_t *state)
{
    return ((double)(next_bits(state) >> 11) + 0.5) / 9007199254740992.0;
}

double sim_gauss(uint64_t *state)
{
    const double u = sim_uniform(state), v = sim_uniform(state);

    return sqrt(-2 * log(u)) * cos(TWO_PI * v);
}

double sim_sum(const sim_multisine *m, double t)
{
    double sum = 0;
    int i;

    for (i = 0; i < m->count; ++i) {
        sum += m->amplitude[i] * sin(m->omega[i] * t + m->phase[i]);
    }
    return sum;
}

/* Whether the misfits that act for a part of the time act at t. */
static int acts(const sim_parameters *p, double t)
{
    return !(p->off > 0) || (t >= p->on && t < p->off);
}

static double ramp(const sim_parameters *p, double t, double change)
{
    if (p->drift_time < 0) { /* from -drift_time on, as long again */
        return 1 + change * fmin(fmax(t / -p->drift_time - 1, 0), 1);
    }
    return p->drift_time > 0 ? 1 + change * fmin(t / p->drift_time, 1) : 1;
}

/* What the derivatives consist of. */
typedef struct {
    double x, tau_e, sigma, dahl_dot;
    int in_gap;
} spring;

static spring spring_of(const sim_parameters *p, const double *s, double t)
{
    const double r = p->k_s > 0 ? p->r_0 + sim_sum(&p->arm, t) : 0;
    const double factor = ramp(p, t, p->k_drift), v = s[1] - s[3];
    const double kin = p->kin_order > 0 ? p->kin_error * sin(p->kin_order * p->gamma * s[2]) : 0;
    const double deformation = s[0] - s[2] + kin;
    const double x = deformation > p->gap    ? deformation - p->gap
                     : deformation < -p->gap ? deformation + p->gap
                                             : 0;
    spring f;

    f.in_gap = p->gap > 0 && fabs(deformation) <= p->gap;
    f.x = s[0] - s[2];
    if (p->k_s > 0) {
        f.tau_e = p->k_s * r * r * sin(2 * x);
        f.sigma = 2 * p->k_s * r * r * cos(2 * x);
    } else {
        f.tau_e = p->k * x + p->k3 * x * x * x;
        f.sigma = p->k + 3 * p->k3 * x * x;
    }
    f.tau_e *= factor;
    f.sigma *= factor;
    if (f.in_gap) {
        f.sigma = 0;
    }
    f.tau_e += p->damping * f.sigma * v;
    f.dahl_dot = 0;
    if (p->dahl > 0) {
        f.dahl_dot = (v - fabs(v) * s[4]) / p->dahl_phi;
        if (acts(p, t)) {
            f.tau_e += p->dahl * s[4];
        }
    }
    return f;
}

/* Friction of the motor, on its axis, at velocity v behind the gear. */
static double friction(const sim_parameters *p, double t, double v, double tau_e)
{
    const double sign = tanh(v / p->v_coulomb), on = acts(p, t) ? 1 : 0;
    const double D = p->D * ramp(p, t, p->D_drift);
    const double C = p->tau_coulomb * ramp(p, t, p->C_drift);
    double viscous = D * p->gamma * v, coulomb = C * (sign + on * p->uneven);

    if (p->v_cubic > 0) {
        viscous /= sqrt(1 + v * v / (p->v_cubic * p->v_cubic));
    }
    if (p->stribeck > 0) {
        coulomb += C * on * p->stribeck * exp(-v * v / (p->v_stribeck * p->v_stribeck)) * sign;
    }
    return viscous + coulomb + on * p->load_friction * fabs(tau_e) / p->gamma * sign;
}

static void derivative(const sim_parameters *p, const double *s, double t, double tau, double *ds)
{
    const spring f = spring_of(p, s, t);
    const double cogging =
        p->ripple > 0 && acts(p, t) ? p->ripple * sin(p->ripple_order * p->gamma * s[2]) : 0;

    ds[0] = s[1];
    ds[1] = (p->load - p->D_q * s[1] - p->mgl * sin(s[0]) - p->contact_k * s[0] -
             p->contact_d * s[1] - f.tau_e) /
            p->M;
    ds[2] = s[3];
    ds[3] =
        (tau - friction(p, t, s[3], f.tau_e) + cogging + f.tau_e / p->gamma) / (p->B * p->gamma);
    ds[4] = f.dahl_dot;
}

/* Torque without control at a time. */
static double command(const sim_parameters *p, double t)
{
    return t < p->rest ? 0 : sim_sum(&p->torque, t - p->rest);
}

/* Open loop: linear from sample to sample. */
static double torque_at(const sim *s, double t)
{
    const double T = s->p->T, k = floor(t / T), share = t / T - k;

    if (s->p->hold) {
        return s->u[0];
    }
    return (1 - share) * command(s->p, k * T) + share * command(s->p, (k + 1) * T);
}

static void advance(sim *s, double until)
{
    const sim_parameters *p = s->p;
    const double h = (until - s->t) / p->substeps;
    double a[5], b[5], c[5], d[5], y[5];
    int n, i;

    if (!(h > 0)) {
        return;
    }
    for (n = 0; n < p->substeps; ++n) {
        const double t = s->t + n * h, middle = torque_at(s, t + h / 2);

        derivative(p, s->x, t, torque_at(s, t), a);
        for (i = 0; i < 5; ++i) {
            y[i] = s->x[i] + h / 2 * a[i];
        }
        derivative(p, y, t + h / 2, middle, b);
        for (i = 0; i < 5; ++i) {
            y[i] = s->x[i] + h / 2 * b[i];
        }
        derivative(p, y, t + h / 2, middle, c);
        for (i = 0; i < 5; ++i) {
            y[i] = s->x[i] + h * c[i];
        }
        derivative(p, y, t + h, torque_at(s, t + h), d);
        for (i = 0; i < 5; ++i) {
            s->x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
        }
    }
    s->t = until;
}

static double encoder(double x, double counts)
{
    const double count = counts > 0 ? TWO_PI / counts : 0;

    return counts > 0 ? floor(x / count + 0.5) * count : x;
}

void sim_start(sim *s, const sim_parameters *p)
{
    memset(s, 0, sizeof *s);
    s->p = p;
    s->random = p->seed * 7919 + 12345;
    /* At rest; a constant load has deformed the spring. */
    if (!(p->k_s > 0)) {
        s->x[2] = p->reference_0;
    }
    s->x[0] = s->x[2];
    if (p->mgl > 0) {
        s->x[0] = s->x[2] - p->mgl * sin(s->x[2]) / p->k;
    }
    if (fabs(p->load) > 0) {
        s->x[0] =
            s->x[2] + (p->k_s > 0 ? p->load / (2 * p->k_s * p->r_0 * p->r_0) : p->load / p->k);
    }
    s->theta_0 = s->x[2];
    s->q_0 = s->x[0];
}

/* Torque that the drive holds from this sample on. */
static double control(sim *s, double theta, double q, double t)
{
    const sim_parameters *p = s->p;
    const double wanted = p->reference_0 + sim_sum(&p->reference, t) - sim_sum(&p->reference, 0);
    double u = command(p, t);

    if (p->kp > 0) { /* velocities through a low pass of 200 rad/s */
        const double share = 1 - exp(-200 * p->T);
        s->velocity[0] += share * ((theta - s->theta_0) / p->T - s->velocity[0]);
        s->velocity[1] += share * ((q - s->q_0) / p->T - s->velocity[1]);
        u += p->kp * (wanted - theta) - p->kd * s->velocity[0] - p->kq * s->velocity[1];
    }
    s->theta_0 = theta;
    s->q_0 = q;
    return u;
}

void sim_next(sim *s, sim_sample *out)
{
    const sim_parameters *p = s->p;
    const double at = (double)s->tick * p->T;
    const double t =
        fmax(at + (p->jitter > 0 && s->tick > 0 ? p->jitter * sim_gauss(&s->random) : 0), s->t);
    spring f;
    double q, theta, tau;

    advance(s, t);
    f = spring_of(p, s->x, t);
    theta = s->x[2] + p->eccentric_theta * sin(p->gamma * s->x[2] + 0.7);
    q = s->x[0] + p->eccentric_q * sin(s->x[0] + 0.4) + p->zero + p->skew * s->x[1];
    out->theta = encoder(theta, p->counts_theta);
    out->q = encoder(q, p->counts_q);
    out->r = p->k_s > 0 ? p->r_0 + sim_sum(&p->arm, t) : 0;
    out->sigma = f.sigma;
    out->phi = f.x;
    out->tau_e = f.tau_e;
    out->in_gap = f.in_gap;
    if (p->hold) {
        const double late = fmin(fmax(p->late / p->T, 0), 1);
        s->u[1] = s->u[0];
        s->u[0] = control(s, out->theta, out->q, at);
        tau = p->hold == 1 ? s->u[0] : (s->u[0] + s->u[1]) / 2;
        tau += late * (s->u[1] - tau);
    } else {
        tau = torque_at(s, t - (acts(p, t) ? p->late : 0));
    }
    out->tau = (tau - p->bias) / p->gain + p->noise_tau * sim_gauss(&s->random);
    out->sensor = f.tau_e + p->noise_sensor * sim_gauss(&s->random);
    s->tick += 1;
}
