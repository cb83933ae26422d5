/* The estimate: coefficients of all columns, and what they say about the motor. */
#include <string.h>

#include "real_math.h"
#include "regression.h"

static sh_real relative_error(const sh_coefficients *coefficients, const sh_columns *columns,
                              int kind)
{
    const int i = sh_columns_place(columns, kind);

    return i >= 0 ? columns->column[i].prior * coefficients->beta[i] : 0;
}

void sh_coefficients_start(sh_coefficients *coefficients, const sh_parameters *p)
{
    (void)memset(coefficients, 0, sizeof *coefficients);
    coefficients->viscous_std = p->prior.D_theta;
}

void sh_coefficients_solve(sh_coefficients *coefficients, const sh_posterior *posterior,
                           const sh_columns *columns, const sh_parameters *p)
{
    sh_posterior_estimate(posterior, columns->size, p->prior.B, coefficients->beta,
                          coefficients->per_gain);
    coefficients->viscous = relative_error(coefficients, columns, SH_COLUMN_VISCOUS);
    coefficients->inertia = relative_error(coefficients, columns, SH_COLUMN_INERTIA);
}

void sh_coefficients_judge_viscous(sh_coefficients *coefficients, const sh_posterior *posterior,
                                   const sh_columns *columns, const sh_parameters *p)
{
    const int i = sh_columns_place(columns, SH_COLUMN_VISCOUS);

    if (i >= 0) {
        sh_real c[SH_MAX_COLUMNS] = {0};

        c[i] = columns->column[i].prior;
        coefficients->viscous_std = sh_std_deviation(
            sh_posterior_variances(posterior, p->prior.B, c, c, columns->size).first);
    }
}
