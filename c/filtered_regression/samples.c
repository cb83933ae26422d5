/* The data of all samples: their information, and the sums that describe the noise in it (section 6). */
#include <string.h>

#include "real_math.h"
#include "regression.h"

void sh_samples_start(sh_samples *samples, int size)
{
    const sh_column_noise none = {0, 0};

    sh_information_start(&samples->data, size, SH_LEAST_INFORMATION);
    samples->weights = samples->surplus = samples->spread = 0;
    samples->noise = none;
    samples->drift.w = 0;
}

void sh_samples_count_noise(sh_samples *samples, const sh_column_noise *left, sh_real w, sh_real N,
                            sh_real Q)
{
    samples->noise.information += sh_limited(left->information * w, SH_LARGE);
    samples->noise.gain += sh_limited(left->gain * w, SH_LARGE);
    samples->weights += sh_limited(w, SH_LARGE);
    samples->surplus += N;
    samples->spread += Q;
}

void sh_samples_take(sh_samples *samples, const sh_row *row, int first, sh_sample *rest)
{
    const int size = samples->data.size;
    sh_real x[SH_MAX_ROW], w;

    (void)memcpy(x, row->x, sizeof x);
    w = sh_information_take_rows(&samples->data, 0, first, x, row->w);
    if (rest) {
        int i;

        rest->w = first < size ? w : 0;
        (void)memcpy(rest->x, x, sizeof x);
        for (i = 0; i < first; ++i) {
            rest->x[i] = 0;
        }
    }
    (void)sh_information_take_rows(&samples->data, first, size, x, w);
}

void sh_samples_forget(sh_samples *samples, sh_real factor)
{
    sh_information_forget(&samples->data, factor, SH_LEAST_INFORMATION);
    samples->surplus *= factor;
    samples->spread *= factor * factor;
    samples->weights *= factor;
    samples->noise.information *= factor;
    samples->noise.gain *= factor;
}

void sh_samples_drift(sh_samples *samples, const sh_real *v, sh_real variance)
{
    samples->weights *= sh_information_drift(&samples->data, v, variance);
}

void sh_sample_prepare(sh_sample *sample, const sh_information *a, int column, sh_real variance)
{
    sample->w = 0;
    if (column >= 0 && column < a->size) {
        sample->w = sh_information_drift_sample(a, column, variance, sample->x);
    }
}

void sh_sample_take(sh_sample *sample, sh_information *a)
{
    if (sample->w < 0) {
        (void)sh_information_take(a, sample->x, sample->w);
    }
    sample->w = 0;
}

void sh_samples_prepare_drift(sh_samples *samples, int column, sh_real variance)
{
    sh_sample_prepare(&samples->drift, &samples->data, column, variance);
}

void sh_samples_take_drift(sh_samples *samples)
{
    sh_sample_take(&samples->drift, &samples->data);
}

void sh_samples_replace(sh_samples *samples, const sh_information *data)
{
    samples->data = *data;
    samples->surplus = samples->spread = samples->weights = 0;
    samples->noise.information = samples->noise.gain = 0;
}
