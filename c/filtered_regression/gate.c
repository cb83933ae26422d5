/* The gate: finds samples that no joint can give, before the samples reach filters and sums (F30). */
#include "method.h"
#include "real_math.h"
#include "regression.h"

/* Largest innovation, divided by the largest innovation of late [1]. */
#define SH_GATE_RATIO ((sh_real)10)
/* Time constant with which the largest innovation falls [s]: motions that come once in a minute stay known. */
#define SH_GATE_MEMORY ((sh_real)60)
/* Time for which a signal is refused at most [s]: a level that persists is one of the joint. A sample of a log at 10 Hz is
 * refused once.
 */
#define SH_GATE_WAIT ((sh_real)0.12)
/* Time and samples in which the largest innovation is learned [s, 1]. */
#define SH_GATE_LEARNING ((sh_real)0.1)
#define SH_GATE_SAMPLES 20
/* Largest innovation that is accepted in any case: of the torque, divided by its scale [1]; of positions, in encoder counts
 * [1]. An encoder at rest may begin to move at any time.
 */
#define SH_GATE_SHARE ((sh_real)0.5)
#define SH_GATE_COUNTS ((sh_real)4)
/* Largest torque, deformation and set-point, divided by their scales [1]. */
#define SH_GATE_IMPOSSIBLE ((sh_real)1000)

/* Returns the largest torque of the spring that the parameters let expect [N.m]. */
static sh_real largest_load(const sh_columns *columns, const sh_parameters *p)
{
    const sh_real at_rest[SH_WIDTHS] = {0};
    sh_joint_point at;
    sh_real load = p->prior.tau_e;

    if (columns->has_nominal) {
        sh_joint_point_at(&at, columns, p, 0, 0, p->range.phi, p->setPoint.offset, at_rest);
        load += sh_fabs(at.tau_nominal) + sh_fabs(at.sigma_nominal) * p->range.phi;
    }
    return load > 0 && load < SH_LARGEST_MEASUREMENT ? load : SH_LARGEST_MEASUREMENT;
}

static void set_limits(sh_gate_signal *signal, sh_real scale, sh_real least, sh_real largest)
{
    signal->scale = scale;
    signal->least = least;
    signal->largest = largest;
}

/* The largest load accelerates the motor alone by load / (gamma^2 B). */
void sh_gate_start(sh_gate *gate, const sh_columns *columns, const sh_parameters *p)
{
    const sh_gate nothing = {0};
    const sh_real load = largest_load(columns, p), gamma = sh_fabs(p->motor.gamma);
    const sh_real accelerated =
        load / (p->motor.B * gamma * gamma) * p->samplePeriod * p->samplePeriod;
    const sh_real moved = accelerated < p->range.phi ? accelerated : p->range.phi;
    const sh_real count = sh_encoder_count(p->encoder.theta);
    const sh_real both = count + sh_encoder_count(p->encoder.q);
    const sh_real torque = sh_is_measured(p) ? load : load / gamma + p->prior.tau_coulomb;
    const sh_real noise = SH_GATE_RATIO * (sh_is_measured(p) ? p->noise.tau_e : p->noise.tau);
    sh_gate_signal *signal = gate->signal;

    *gate = nothing;
    set_limits(&signal[SH_GATE_THETA], p->range.phi, SH_GATE_COUNTS * count + moved, SH_LARGE);
    set_limits(&signal[SH_GATE_PHI], p->range.phi, SH_GATE_COUNTS * both + moved,
               SH_GATE_IMPOSSIBLE * p->range.phi);
    set_limits(&signal[SH_GATE_SET_POINT], p->range.setPoint, p->range.setPoint, SH_LARGE);
    set_limits(&signal[SH_GATE_TORQUE], torque + noise, SH_GATE_SHARE * torque + noise,
               SH_GATE_IMPOSSIBLE * torque + noise);
}

/* Begins with a sample x. Returns 1 if the sample is possible.
 *
 * step  change since the last sample, 0 if there is none
 */
static int begin_signal(sh_gate_signal *signal, sh_real x, sh_real step)
{
    signal->last = signal->newest = x;
    signal->step = step;
    signal->jump = 0;
    signal->refused = 0;
    return sh_fabs(x) <= signal->largest;
}

/* Refuses a sample with this innovation, unless the signal has been refused for long enough. Returns 1 if the sample is
 * accepted all the same.
 */
static int refuse_sample(sh_gate_signal *signal, sh_real x, sh_real innovation, int learns,
                         sh_real T)
{
    if (signal->refused == 0 && !learns) {
        signal->jump = innovation;
    }
    if (((sh_real)signal->refused + 1) * T >= SH_GATE_WAIT && sh_fabs(x) <= signal->largest) {
        /* The next jump of this size is accepted at once. */
        signal->peak = sh_fmax(signal->peak, 2 / SH_GATE_RATIO * signal->jump);
        return 1;
    }
    if (signal->refused < SH_MOST_TICKS) {
        signal->refused += 1;
    }
    signal->newest = x;
    return 0;
}

/* Returns 1 if a sample x follows the signal, and updates the signal. Each signal is followed by itself, so that a signal
 * without errors is still known after another one was refused.
 *
 * steps   share of the last step in the prediction: 1 for a position, 0 for a torque
 * learns  1: the usual innovations are not known yet
 */
static int follow_signal(sh_gate_signal *signal, sh_real x, sh_real steps, int learns, sh_real T)
{
    const sh_real ahead = (sh_real)signal->refused + 1; /* samples since the last accepted one */
    const sh_real change = x - signal->last;
    const sh_real innovation = sh_fabs(change - ahead * signal->step);
    const sh_real usual = SH_GATE_RATIO * signal->peak;
    const sh_real least = learns ? signal->scale : signal->least;
    sh_real step = change;

    if (innovation <= usual || innovation <= least) {
        signal->peak -= T / SH_GATE_MEMORY * signal->peak;
        if (innovation > signal->peak) {
            signal->peak = innovation;
        }
        if (signal->refused > 0) {
            step /= ahead;
        }
    } else if (refuse_sample(signal, x, innovation, learns, T)) {
        step = x - signal->newest;
    } else {
        return 0;
    }
    return begin_signal(signal, x, steps * step);
}

int sh_gate_take(sh_gate *gate, const sh_parameters *p, const sh_measurement *z, sh_real set_point,
                 int skipped)
{
    const sh_real T = p->samplePeriod;
    const int signals = p->rls.m > 1 ? SH_GATE_SIGNALS : SH_GATE_SET_POINT;
    sh_gate_signal *signal = gate->signal;
    sh_real x[SH_GATE_SIGNALS];
    int i, learns, accepted = 1;

    x[SH_GATE_THETA] = z->theta;
    x[SH_GATE_PHI] = z->q - z->theta;
    x[SH_GATE_TORQUE] = sh_regression_torque(p, z, z->tau);
    x[SH_GATE_SET_POINT] = set_point - p->range.setPoint_center;
    if (skipped != gate->skipped) { /* samples are missing */
        gate->samples = 0;
    }
    learns = gate->samples < SH_GATE_SAMPLES || (sh_real)gate->samples * T < SH_GATE_LEARNING;
    /*@ loop unroll SH_GATE_SIGNALS; */
    for (i = 0; i < signals; ++i) {
        if (gate->samples == 0) {
            accepted &= begin_signal(&signal[i], x[i], 0);
        } else if (gate->samples == 1 && i != SH_GATE_TORQUE) { /* at any velocity */
            accepted &= begin_signal(&signal[i], x[i], x[i] - signal[i].last);
        } else {
            accepted &= follow_signal(&signal[i], x[i], i == SH_GATE_TORQUE ? 0 : 1, learns, T);
        }
    }
    if (accepted && gate->samples < SH_MOST_TICKS) {
        gate->samples += 1;
    }
    gate->skipped = accepted ? 0 : skipped + (skipped < SH_MOST_TICKS ? 1 : 0);
    return accepted;
}
