/* Estimates with their covariance, for a comparison with those of another log. A program that does not call
 * sh_estimator_covariance does not contain this code.
 */
#include "method.h"
#include "pair.h"
#include "real_math.h"
#include "regression.h"

/* Estimate i is offset + c' beta: the stiffness at point i, or behind the points the quantity i - count. */
typedef struct {
    sh_real c[SH_MAX_COLUMNS];
    sh_real offset;
} linear_estimate;

static void stiffness_at(const sh_regression_state *state, const sh_parameters *p, sh_real phi,
                         sh_real set_point, linear_estimate *estimate)
{
    const sh_real at_rest[SH_WIDTHS] = {0};
    sh_joint_point at;
    int i;

    sh_joint_point_at(&at, &state->columns, p, 0, 0, phi, set_point, at_rest);
    (void)sh_columns_judge_knees(&state->columns, p, state->coefficients.beta, &at);
    for (i = 0; i < state->columns.spring; ++i) {
        estimate->c[i] = at.dF[i];
    }
    estimate->offset = at.sigma_nominal;
}

/* Returns the change of a quantity with the coefficient of a column, whose factor `prior` is 1. */
static sh_real slope_of(int quantity, int kind, const sh_parameters *p)
{
    switch (kind) {
    case SH_COLUMN_INERTIA:
        return quantity == SH_QUANTITY_B ? p->motor.B : 0;
    case SH_COLUMN_VISCOUS:
        return quantity == SH_QUANTITY_D_THETA ? p->motor.D_theta : 0;
    case SH_COLUMN_COULOMB:
        return quantity == SH_QUANTITY_TAU_COULOMB ? 1 : 0;
    case SH_COLUMN_LOAD:
    case SH_COLUMN_DRIVE:
        return quantity == SH_QUANTITY_LOAD_FRICTION ? 1 : 0;
    case SH_COLUMN_HYSTERESIS:
        return quantity == SH_QUANTITY_HYSTERESIS ? 1 : 0;
    case SH_COLUMN_DEAD_ZONE: /* its column is 1 beyond the zone */
        return quantity == SH_QUANTITY_LOST_TORQUE ? -1 : 0;
    default:
        return 0;
    }
}

static void quantity_of(const sh_regression_state *state, const sh_parameters *p, int quantity,
                        linear_estimate *estimate)
{
    int i;

    for (i = 0; i < state->columns.size; ++i) {
        const sh_column *column = &state->columns.column[i];

        estimate->c[i] = column->prior * slope_of(quantity, column->kind, p);
    }
    if (quantity == SH_QUANTITY_B) {
        estimate->offset = p->motor.B;
    } else if (quantity == SH_QUANTITY_D_THETA) {
        estimate->offset = p->motor.D_theta;
    }
}

/* Returns estimate i, whose vector c is multiplied by a factor. */
static linear_estimate estimate_of(const sh_regression_state *state, const sh_parameters *p, int i,
                                   int count, const sh_real *phi, const sh_real *set_point,
                                   sh_real factor)
{
    linear_estimate estimate = {{0}, 0};
    int k;

    if (i < count) {
        stiffness_at(state, p, phi[i], set_point[i], &estimate);
    } else {
        quantity_of(state, p, i - count, &estimate);
    }
    for (k = 0; k < state->columns.size; ++k) {
        estimate.c[k] *= factor;
    }
    return estimate;
}

static sh_variances variances_of(const sh_regression_state *state, const sh_parameters *p,
                                 const linear_estimate *first, const linear_estimate *second)
{
    return sh_posterior_variances(&state->posterior, p->prior.B, first->c, second->c,
                                  state->columns.size);
}

/* The covariance of a and b is the difference of the variances of a + b and a - b, over 4. Both are divided by their
 * std deviations before, as the units differ by many orders of magnitude.
 */
static sh_real correlation_of(const sh_regression_state *state, const sh_parameters *p,
                              const linear_estimate *a, const linear_estimate *b)
{
    linear_estimate sum = *a, difference = *a;
    sh_variances variances;
    int k;

    for (k = 0; k < state->columns.size; ++k) {
        sum.c[k] += b->c[k];
        difference.c[k] -= b->c[k];
    }
    variances = variances_of(state, p, &sum, &difference);
    return sh_limited((variances.first - variances.second) / 4, 1);
}

int sh_estimator_covariance(const sh_estimator *estimator, const sh_parameters *p, int count,
                            const sh_real *phi, const sh_real *setPoint, sh_real *values,
                            sh_real *per_gain, sh_real *covariance)
{
    const sh_regression_state *state = &estimator->method.regression;
    const int size = count + SH_QUANTITIES;
    int i, j;

    if (p->method != SH_METHOD_FILTERED_REGRESSION) {
        return 1;
    }
    for (i = 0; i < size; ++i) {
        const linear_estimate own = estimate_of(state, p, i, count, phi, setPoint, 1);

        sh_scalar_products(own.c, state->coefficients.beta, state->coefficients.per_gain,
                           state->columns.size, &values[i], &per_gain[i]);
        values[i] += own.offset;
        covariance[i * size + i] = variances_of(state, p, &own, &own).first;
    }
    for (i = 0; i < size; ++i) {
        const sh_real own_std = sh_sqrt(covariance[i * size + i]);

        for (j = 0; j < i; ++j) {
            const sh_real std = sh_sqrt(covariance[j * size + j]);
            sh_real found = 0;

            if (std > 0 && own_std > 0 && isfinite(std) && isfinite(own_std)) {
                const linear_estimate a =
                    estimate_of(state, p, i, count, phi, setPoint, 1 / own_std);
                const linear_estimate b = estimate_of(state, p, j, count, phi, setPoint, 1 / std);

                found = correlation_of(state, p, &a, &b) * std * own_std;
            }
            covariance[i * size + j] = covariance[j * size + i] = found;
        }
    }
    return 0;
}
