/* Ticks of a sampled model inside communication steps of any size.
 *
 * Ticks are at start + k T; a step from t to t + h runs those with t <= t_k < t + h.
 */
#ifndef SH_SAMPLE_CLOCK_H
#define SH_SAMPLE_CLOCK_H

typedef struct {
    double ahead; /* next tick, in periods after the communication point */
} sh_sample_clock;

/* Starts the clock: the first tick is at the current communication point. */
void sh_sample_clock_start(sh_sample_clock *clock);

/* Whether a clock that comes from outside can be one between steps. Another one could be so far behind
 * that it does not reach the end of a step.
 */
int sh_sample_clock_is_state(const sh_sample_clock *clock);

/* Returns 1 if a tick is due before the end of a step of h seconds; then *after is its time after
 * the begin of the step [s], and the next call asks for the next tick. Returns 0 if not; then the
 * clock has moved to the end of the step.
 *
 * The clock counts in periods T and not in the importer's time, whose rounding errors add up: a
 * step of length T is one tick, for any number of steps. A tick within 1e-6 of a period of the end
 * of the step belongs to the next step.
 */
int sh_sample_clock_tick(sh_sample_clock *clock, double h, double T, double *after);

#endif
