#include "endurance_input.h"

#include <math.h>

/* The AwAS of sh_parameters_default, its motor data wrong by some percent. */
static const double T = 1e-3, GAMMA = 50.0, B = 2.3e-5, D_THETA = 1.1e-3, COULOMB = 0.02;
static const double K_S = 14220.0, R_0 = 0.1, LEAD = 3.9788735772973837e-4;
static const double TURN = 6.283185307179586;

static input_pointer pointer(double frequency)
{
    const double angle = TURN * frequency * T;
    const input_pointer start = {1.0, 0.0, cos(angle), sin(angle)};

    return start;
}

static void turn(input_pointer *p)
{
    const double c = p->c * p->step_c - p->s * p->step_s;
    const double s = p->s * p->step_c + p->c * p->step_s;
    const double shrink = 1.5 - 0.5 * (c * c + s * s); /* its length stays 1 */

    p->c = c * shrink;
    p->s = s * shrink;
}

/* Uniform in -1..1 (xorshift, Marsaglia 2003). */
static double noise(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) / 4503599627370496.0 - 1.0;
}

static double counted(double angle)
{
    return floor(angle * (INPUT_COUNTS / TURN) + 0.5) * (TURN / INPUT_COUNTS);
}

void input_start(input_stream *input, double torque)
{
    static const input_stream zero;

    *input = zero;
    input->torque = torque;
    input->fast = pointer(1.7137);
    input->slow = pointer(0.31313);
    input->bend = pointer(0.7713);
    input->twist = pointer(2.2917);
    input->secondary = pointer(0.053113);
    input->random = 88172645463325252u;
}

static input_sample moving(input_stream *input)
{
    const input_pointer *f = &input->fast, *g = &input->slow;
    const double w_f = TURN * 1.7137, w_g = TURN * 0.31313;
    const double theta = 0.2 * f->s + 0.5 * g->s;
    const double theta_dot = 0.2 * w_f * f->c + 0.5 * w_g * g->c;
    const double theta_ddot = -0.2 * w_f * w_f * f->s - 0.5 * w_g * w_g * g->s;
    const double phi = 0.09 * input->bend.s + 0.06 * input->twist.s;
    const double theta_c = 60.0 * input->secondary.s;
    const double r = R_0 - LEAD * theta_c;
    const double tau_e = K_S * r * r * 2.0 * phi * (1.0 - phi * phi);
    const double friction = theta_dot > 0.0 ? COULOMB : -COULOMB;
    input_sample z;

    z.theta = counted(theta);
    z.q = counted(theta + phi);
    z.theta_c = counted(theta_c);
    z.tau = GAMMA * (B * theta_ddot + D_THETA * theta_dot) + friction - tau_e / GAMMA +
            5e-3 * noise(&input->random);
    z.tau_e_sensor = tau_e + 5e-2 * noise(&input->random);
    z.modality = 1;
    return z;
}

input_sample input_next(input_stream *input)
{
    const long phase = input->tick++ % INPUT_CYCLE;
    input_sample z;

    turn(&input->fast);
    turn(&input->slow);
    turn(&input->bend);
    turn(&input->twist);
    turn(&input->secondary);
    z = moving(input);
    if (phase < 40000) {
        input->held = z;
        return z;
    }
    if (phase < 50000) { /* the joint is at rest */
        return input->held;
    }
    if (phase < 60000) { /* the encoder of the motor saturates */
        z.theta = fmin(fmax(z.theta, -0.25), 0.25);
        return z;
    }
    if (phase < 61000) { /* a torque larger than that of any joint */
        z.tau *= input->torque;
        z.tau_e_sensor *= input->torque;
        return z;
    }
    if (phase >= 70000 && phase < 80000) { /* the modality changes */
        z.modality = 1 + (int)(phase / 500 % 3);
    }
    if (phase >= 80000 && phase < 82000 && phase % 100 == 0) { /* single samples are lost */
        z.q = NAN;
    }
    if (phase >= 82000 && phase < 83000) { /* all samples of a second are lost */
        z.tau = INFINITY;
    }
    return z;
}
