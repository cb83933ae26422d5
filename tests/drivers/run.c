#include "run.h"

long test_run(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
              long samples, long ticks, sh_estimate *estimate, sh_estimate *record)
{
    long good = 0;
    for (long k = 0; k < ticks; ++k) {
        good += sh_estimator_tick(estimator, p, &z[k % samples], estimate) == 0;
        if (record) {
            record[k] = *estimate;
        }
    }
    return good;
}
