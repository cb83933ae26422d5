/* Outputs that are computed from the coefficients, and the reason why the estimate is not confident. */
#include "method.h"
#include "real_math.h"
#include "regression.h"

/* Squared misfit above which the estimate is in doubt, and number of blocks below which this limit holds [1]. With more
 * blocks, most columns that may explain the misfit have been tried, and the variance factor is sufficient.
 */
#define SH_UNEXPLAINED ((sh_real)2.25)
#define SH_UNTRIED_BLOCKS ((sh_real)35)
/* With N blocks, the variance is multiplied by 1 + SH_UNJUDGED_BLOCKS / N [1]. In the first half second, joints with
 * several misfits are then wrong for 1.4 % (without the factor, 4.6 %) of the confident time.
 */
#define SH_UNJUDGED_BLOCKS ((sh_real)10)
/* Deviation of a motor parameter above which the estimate is in doubt, in std deviations of the prior [1]. */
#define SH_OUTSIDE_PRIOR ((sh_real)3)
/* Distance of viscous friction below 0 from which the estimate is in doubt, in std deviations [1]. Such a friction
 * shows that the encoders are read at different times. Of 40 simulated logs, only the eight with a late encoder had
 * such a friction.
 */
#define SH_BELOW_ZERO ((sh_real)1)

/* Converts the coefficients of powers of s - c to coefficients of powers of the set-point s, by Horner's scheme. */
static void shift_set_point(sh_estimate *estimate, sh_real c)
{
    int i, j, k;

    for (i = 0; i < SH_MAX_N; ++i) {
        for (k = 0; k < SH_MAX_M - 1; ++k) {
            for (j = SH_MAX_M - 2; j >= k; --j) {
                const sh_real shifted = estimate->eta[i][j] - c * estimate->eta[i][j + 1];

                estimate->eta[i][j] = sh_limited(shifted, SH_LARGEST_OUTPUT);
            }
        }
    }
}

/* Sets the coefficients eta, and adds up the coefficients of each kind of column in sum [size: SH_COLUMN_KINDS]. */
static void read_coefficients(const sh_columns *columns, const sh_real *beta,
                              const sh_parameters *p, const sh_joint_point *at, sh_real *sum,
                              sh_estimate *estimate)
{
    int i, j;

    for (i = 0; i < columns->size; ++i) {
        const sh_column *column = &columns->column[i];
        sh_real value = column->prior * beta[i];

        if (sh_column_is(column, SH_IS_POWER)) {
            estimate->eta[column->i][column->j] =
                sh_limited(value * column->unit, SH_LARGEST_OUTPUT);
        } else if (column->kind == SH_COLUMN_DAMPING) {
            value *= sh_limited(at->l[column->j], SH_LARGE);
        }
        sum[column->kind] += value;
    }
    if (sh_fabs(p->range.setPoint_center) > 0 && p->prior.tau_e > 0) {
        shift_set_point(estimate, p->range.setPoint_center);
    }
    for (i = 0; i < p->rls.n && columns->has_nominal; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            estimate->eta[i][j] = (p->prior.tau_e > 0 ? estimate->eta[i][j] : 0) +
                                  (1 + sum[SH_COLUMN_NOMINAL]) * p->rls.eta_0[i][j];
        }
    }
}

void sh_report_coefficients(const sh_columns *columns, const sh_coefficients *coefficients,
                            const sh_parameters *p, const sh_joint_point *at, sh_estimate *estimate)
{
    sh_real sum[SH_COLUMN_KINDS] = {0}, turning;

    read_coefficients(columns, coefficients->beta, p, at, sum, estimate);
    turning = sh_sqrt(sh_square(sum[SH_COLUMN_SIN_Q]) + sh_square(sum[SH_COLUMN_COS_Q]));
    estimate->D_theta_hat = p->motor.D_theta * (1 + coefficients->viscous);
    estimate->B_hat = p->motor.B * (1 + coefficients->inertia);
    estimate->tau_coulomb_hat = sum[SH_COLUMN_COULOMB];
    estimate->bias_hat = sum[SH_COLUMN_BIAS];
    estimate->damping_hat = sum[SH_COLUMN_DAMPING];
    estimate->load_friction_hat = sum[SH_COLUMN_LOAD] + sum[SH_COLUMN_DRIVE];
    estimate->eccentric_hat =
        turning > 0 ? turning / sh_fmax(sh_fabs(estimate->sigma), turning) : 0; /* at most 1 rad */
    estimate->delay_hat = sum[SH_COLUMN_DELAY];
    estimate->hysteresis_hat = sum[SH_COLUMN_HYSTERESIS];
}

/* (F26). The misfit increases sigma_std. For few blocks, the misfit also has a limit of its own, because some columns that may
 * explain the misfit have not been tried. With N blocks, c' P c is multiplied by 1 + 10/N for this decision
 * alone, not in sigma_std, because few blocks hardly show whether the model holds.
 */
int sh_report_doubt(const sh_estimate *estimate, const sh_coefficients *coefficients,
                    sh_real variance, const sh_bank *bank, const sh_misfit *misfit,
                    const sh_parameters *p)
{
    const sh_real phi = sh_fabs(estimate->phi), N = sh_fmax(bank->count, 1);
    const sh_real unjudged = p->regression.memory > 0 ? variance * SH_UNJUDGED_BLOCKS / N : 0;
    int doubt = SH_DOUBT_NONE;

    if (!(sh_square(estimate->sigma_std) + unjudged <
          sh_square(p->limit.relative_std * estimate->sigma))) {
        doubt = misfit->variance_factor > SH_CONTRADICTION ? SH_DOUBT_MISFIT : SH_DOUBT_NOT_EXCITED;
    }
    if (p->regression.memory > 0 && bank->count < SH_UNTRIED_BLOCKS &&
        misfit->square > SH_UNEXPLAINED) {
        doubt = SH_DOUBT_MISFIT;
    }
    if (phi > SH_LEAST_LIMIT * p->range.phi && phi > sh_largest_deformation(p)) {
        doubt = SH_DOUBT_OUT_OF_RANGE;
    }
    if (sh_fabs(coefficients->viscous) > SH_OUTSIDE_PRIOR * p->prior.D_theta ||
        1 + coefficients->viscous < -SH_BELOW_ZERO * coefficients->viscous_std) {
        doubt = SH_DOUBT_FRICTION;
    }
    if (sh_fabs(coefficients->inertia) > SH_OUTSIDE_PRIOR * p->prior.B) {
        doubt = SH_DOUBT_INERTIA;
    }
    if (estimate->sigma < 0) {
        doubt = SH_DOUBT_NEGATIVE_STIFFNESS;
    }
    if (sh_bank_doubts(bank) || sh_misfit_is_sudden(misfit)) {
        doubt = SH_DOUBT_CHANGE;
    }
    return doubt;
}
