/* Any number of ticks with any measurements, from the start or from a state that passes
 * sh_estimator_check. The loop is analysed to a fixpoint.
 */
#include "anything.h"
#include "contracts.h"

static sh_estimator estimator;
static sh_parameters p;
static sh_estimate estimate;

static void tick(void)
{
    /*@ loop widen_hints "all", 63; */ /* SH_MAX_COLUMNS - 1 */
    while (Frama_C_nondet(0, 1)) {
        sh_measurement z;

        ANYTHING(z);
        any_parameters(&p); /* most may change between ticks */
        sh_estimator_tick(&estimator, &p, &z, &estimate);
    }
    //@ assert reached: \true;
}

void started(void)
{
    any_parameters(&p);
    sh_estimator_start(&estimator, &p, &estimate);
    tick();
}

void restored(void)
{
    any_parameters(&p);
    ANYTHING(estimator);
    ANYTHING(estimate);
    if (sh_estimator_check(&estimator, &p) == 0) {
        //@ slevel merge;
        tick();
    }
}
