/* A row of the regression: the mean of K samples (section 4), its weight, and the error of its prediction. */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Adds the filtered signals, times `share`, to the mean of the row. */
static void add_signals(sh_mean *mean, const sh_filters *filters, const sh_filtered *now,
                        int columns, sh_real share)
{
    int i;

    for (i = 0; i < SH_FILTERS; ++i) {
        mean->filtered.output[i] += share * now->output[i];
        mean->filtered.first[i] += share * now->first[i];
        mean->filtered.second[i] += share * now->second[i];
    }
    for (i = 0; i < columns; ++i) {
        mean->output[i] +=
            share * (filters->input[SH_FILTERS + i] - filters->behind[2][SH_FILTERS + i]);
    }
}

void sh_row_start(sh_row *row, sh_mean *mean)
{
    (void)memset(row, 0, sizeof *row);
    sh_mean_empty(mean);
}

int sh_row_add(sh_row *row, sh_mean *mean, const sh_signals *signals, const sh_columns *columns,
               const sh_feedback *feedback, const sh_parameters *p, const sh_filtered *now,
               sh_real rough)
{
    const sh_real share = 1 / (sh_real)signals->decimation;

    add_signals(mean, &signals->filters, now, columns->filtered, share);
    mean->rough += rough * share;
    mean->moved += sh_fabs(signals->theta_before[0] - signals->theta_before[1]) > 0 ? share : 0;
    mean->samples += 1;
    if (mean->samples < signals->decimation) {
        return 0;
    }
    sh_columns_row(columns, mean, feedback, p, row->x);
    row->rough = mean->rough;
    row->moved = mean->moved;
    sh_mean_empty(mean);
    return 1;
}

void sh_mean_empty(sh_mean *mean)
{
    (void)memset(mean, 0, sizeof *mean);
}

int sh_row_weigh(sh_row *row, const sh_row_noise *noise, int size)
{
    const sh_real w = 1 / noise->R;
    const int is_small =
        w > 0 && w * sh_sum_of_products(row->x, row->x, size + SH_RIGHT_SIDES) <= SH_LARGE;

    row->w = is_small ? w : 0;
    row->lasting = noise->lasting;
    return row->w > 0;
}

/* epsilon = y - x' beta without torque noise (F14) */
void sh_row_predict(sh_row *row, const sh_columns *columns, const sh_real *beta,
                    const sh_row_noise *noise, sh_column_noise *left)
{
    const int size = columns->size;
    const sh_real epsilon = row->x[size + SH_RIGHT_Y] - sh_sum_of_products(row->x, beta, size);

    row->epsilon = epsilon - sh_columns_remove_noise(columns, beta, noise, epsilon, row->x, left);
}

void sh_row_compare(sh_row *row, sh_real share)
{
    row->rho = share > 0 ? sh_limited((1 - share) / share, SH_LARGEST_OUTPUT) : SH_LARGEST_OUTPUT;
}

void sh_row_drop_prediction(sh_row *row)
{
    row->epsilon = row->rho = 0;
}
