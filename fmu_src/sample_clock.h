/* Ticks of a sampled model inside communication steps of any size.
 *
 * Ticks are at start + k T; a step from t to t + h runs those with t <= t_k < t + h.
 */
#ifndef SH_SAMPLE_CLOCK_H
#define SH_SAMPLE_CLOCK_H

typedef struct {
    double ahead; /* next tick, in periods after the communication point */
} sh_sample_clock;

/* Starts the clock: the first tick is at the communication point. */
void sh_sample_clock_start(sh_sample_clock *clock);

/* Whether a tick is due before the end of a step of h seconds. If so, *after is
 * its time after the begin of the step [s], and the clock goes on to the next.
 * If not, the clock has moved to the end of the step.
 *
 * Steps are counted in periods T and not in the importer's time, whose rounding
 * adds up: a step of T is one tick, however many of them. A tick within 1e-6 of
 * a period of the end of the step is the next step's.
 */
int sh_sample_clock_tick(sh_sample_clock *clock, double h, double T, double *after);

#endif
