/* Many ticks in one call, for tests that need millions of them. */
#ifndef SH_TEST_RUN_H
#define SH_TEST_RUN_H

#include "sigmahat.h"

/* Runs ticks over the samples z [size: samples]; after the last sample it begins again with the first.
 *
 * estimate  in and out, as for sh_estimator_tick
 * record    [size: ticks] the estimate of every tick, or NULL
 *
 * Returns how many ticks were not skipped.
 */
long test_run(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
              long samples, long ticks, sh_estimate *estimate, sh_estimate *record);

#endif
