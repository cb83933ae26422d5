/* The columns of the regression, and the row of a sample.
 *
 * The equation of motion is the equation (3) of the motor with Coulomb friction. The motor data B and D_theta
 * have the relative errors b and d, and tau_e > 0 for phi > 0 (F1):
 *
 *     gamma^2 B (1 + b) theta'' + gamma^2 D_theta (1 + d) theta' + |gamma| sign(theta') tau_C
 *         = gamma tau + tau_e(q - theta) .
 *
 * With all signals through the filter H (index f), and tau_e = F' eta of (21), the equation of motion is the regression (F3)
 *
 *     y = gamma (B gamma theta''_f + D_theta gamma theta'_f - tau_f)
 *       = F_f' eta - gamma^2 D_theta theta'_f d - gamma^2 B theta''_f b
 *         - |gamma| sign(theta')_f tau_C + further columns (section 1) ,
 *
 * each multiplied by the std deviation of its coefficient, so that all coefficients have the prior N(0, 1). If the
 * torque of the spring is measured or modelled, y is the torque of the spring, and the columns of the motor are 0.
 *
 * To add a kind of column, add a row to sh_column_kinds, a line to list_columns, and a signal to signal_of or an
 * entry to entry_of.
 */
#include <stddef.h>
#include "real_math.h"
#include "regression.h"
#include "torque_basis.h"
#include <string.h>

/* Half widths of dead zones and hysteresis, divided by range.phi [1]. One of the three is near any width. */
#define SH_DEAD_ZONES {(sh_real)0.01, (sh_real)0.04, (sh_real)0.16}
#define SH_HYSTERESES {(sh_real)0.005, (sh_real)0.02, (sh_real)0.08}
/* Share of the covered range above which a half width looks like the spring [1]. Half this share doubles the error. */
#define SH_LOOKS_LIKE_SPRING ((sh_real)0.25)
/* Stiffness within the widest dead zone divided by the stiffness outside [1]. Below this ratio, the zone is a gap and
 * no part of sigma; otherwise, the zone is a knee. A knee of harmonic drives has the ratio 0.5.
 */
#define SH_GAP ((sh_real)0.3)
/* Deformation at a possible knee divided by range.phi [1]. Harmonic drives have a knee at 1/3 of the largest torque. */
#define SH_POSSIBLE_KNEE ((sh_real)0.35)
/* Error of the deformation at a knee, divided by range.phi [1]: `sigmahat identify` finds this deformation to 0.01. */
#define SH_PLACE_OF_KNEE ((sh_real)0.02)
/* Largest entry of a column of the motor encoder [N.m]: a wrong stiffness must not make every row too large. */
#define SH_LARGEST_ENCODER_ERROR SH_FOR(SH_REAL, 1e74, 1e14f)
/* Largest share of torque noise that passes through the column of the motor torque [1]: ten times expected friction. */
#define SH_LARGEST_RETURN ((sh_real)0.5)

static const sh_real DEAD_ZONES[SH_WIDTHS] = SH_DEAD_ZONES;
static const sh_real HYSTERESES[SH_WIDTHS] = SH_HYSTERESES;
/* Indices of the knees: at deformation 0, and on both sides at a first and at a second deformation. */
enum { AT_ZERO, LEFT, RIGHT, SECOND_LEFT, SECOND_RIGHT, KNEES };

int sh_is_measured(const sh_parameters *p)
{
    return p->modality != SH_MODALITY_RESIDUAL;
}

int sh_has_nominal_curve(const sh_parameters *p)
{
    int i, j;

    for (i = 0; i < p->rls.n; ++i) {
        for (j = 0; j < p->rls.m; ++j) {
            if (sh_fabs(p->rls.eta_0[i][j]) > 0) {
                return 1;
            }
        }
    }
    return 0;
}

/* ---- the table --------------------------------------------------------------------------- */

/* Units of std deviations in sh_parameters.prior. IF_DRY is 0 without dry friction, and IF_CURVE without rls.eta_0;
 * else 1.
 */
enum { ONE, TAU_E, K_0, TAU_C, IF_DRY, IF_CURVE };

#define PRIOR(member) (int)offsetof(sh_parameters, prior.member)
#define POWER (SH_IS_CURVE | SH_IS_POWER)

/* A column before DAMPING is the output of a filter with the input signal_of. Other columns are computed in entry_of.
 */
const sh_column_kind sh_column_kinds[SH_COLUMN_KINDS] = {
    [SH_COLUMN_POWER] = {PRIOR(tau_e), ONE, 0, POWER},
    [SH_COLUMN_NOMINAL] = {PRIOR(nominal), IF_CURVE, 0, SH_IS_CURVE},
    [SH_COLUMN_HIGHER_POWER] = {PRIOR(power), TAU_E, 1, POWER},
    [SH_COLUMN_SET_POWER] = {PRIOR(power), TAU_E, 2, POWER},
    [SH_COLUMN_DEAD_ZONE] = {PRIOR(gap), TAU_E, 6, 0},
    [SH_COLUMN_KNEE] = {PRIOR(power), TAU_E, 0, SH_IS_CURVE},
    [SH_COLUMN_POSSIBLE_KNEE] = {PRIOR(power), TAU_E, 3, SH_IS_CURVE},
    [SH_COLUMN_BIAS] = {PRIOR(bias), TAU_E, 0, 0},
    [SH_COLUMN_SIN_Q] = {PRIOR(eccentric), K_0, 0, 0},
    [SH_COLUMN_COS_Q] = {PRIOR(eccentric), K_0, 0, 0},
    [SH_COLUMN_HYSTERESIS] = {PRIOR(hysteresis), TAU_E, 4, 0},
    [SH_COLUMN_DAMPING] = {PRIOR(damping), K_0, 0, 0},
    [SH_COLUMN_DELAY] = {PRIOR(delay), ONE, 0, 0},
    [SH_COLUMN_REVERSAL] = {PRIOR(reversal), TAU_C, 0, 0},
    [SH_COLUMN_SIN_M] = {PRIOR(eccentric_motor), ONE, 5, 0},
    [SH_COLUMN_COS_M] = {PRIOR(eccentric_motor), ONE, 5, 0},
    [SH_COLUMN_LOAD] = {PRIOR(load_friction), ONE, 0, 0},
    [SH_COLUMN_DRIVE] = {PRIOR(load_friction), IF_DRY, 0, 0},
    [SH_COLUMN_VISCOUS] = {PRIOR(D_theta), ONE, 0, 0},
    [SH_COLUMN_COULOMB] = {PRIOR(tau_coulomb), ONE, 0, 0},
    [SH_COLUMN_INERTIA] = {PRIOR(B), ONE, 0, 0},
};

/* Returns the half width of a dead zone or hysteresis, or the deformation at a knee, divided by range.phi [1]; else 0.
 * If the torque is symmetric, a knee at a deformation above 0 is on both sides.
 */
static sh_real width_or_place(const sh_column *column, const sh_parameters *p)
{
    const sh_real first = p->range.knee > 0 ? p->range.knee : SH_POSSIBLE_KNEE,
                  second = p->range.knee_2;
    const sh_real knees[KNEES] = {
        [LEFT] = -first, [RIGHT] = first, [SECOND_LEFT] = -second, [SECOND_RIGHT] = second};

    switch (column->kind) {
    case SH_COLUMN_DEAD_ZONE:
        return DEAD_ZONES[column->i % SH_WIDTHS];
    case SH_COLUMN_HYSTERESIS:
        return HYSTERESES[column->i % SH_WIDTHS];
    case SH_COLUMN_KNEE:
    case SH_COLUMN_POSSIBLE_KNEE:
        return knees[column->i % KNEES];
    default:
        return 0;
    }
}

static int is_knee(const sh_column *column)
{
    return column->kind == SH_COLUMN_KNEE || column->kind == SH_COLUMN_POSSIBLE_KNEE;
}

int sh_columns_place(const sh_columns *columns, int kind)
{
    int i;

    for (i = 0; i < columns->size; ++i) {
        if (columns->column[i].kind == kind) {
            return i;
        }
    }
    return -1;
}

int sh_column_is_distinct(const sh_columns *columns, const sh_signals *signals,
                          const sh_parameters *p, int i)
{
    const sh_column *column = &columns->column[i];
    const sh_real covered = signals->history.phi_max - signals->history.phi_min;

    return is_knee(column) || column->place <= SH_LOOKS_LIKE_SPRING * covered / p->range.phi;
}

/* ---- the list of columns ----------------------------------------------------------------- */

int sh_power_of_phi(int symmetric, int i)
{
    return symmetric ? 2 * i + 1 : i;
}

/* Returns the factor that converts the coefficient of l^j x^e / e to the coefficient of (setPoint - center)^j phi^e. */
static sh_real unit_of_power(const sh_parameters *p, int i, int j)
{
    const int e = sh_power_of_phi(p->rls.symmetric, i);
    sh_real unit = e > 0 ? 1 / (sh_real)e : 1;
    int k;

    for (k = 0; k < e; ++k) {
        unit /= p->range.phi;
    }
    for (k = 0; k < j; ++k) {
        unit /= p->range.setPoint;
    }
    return sh_fmin(unit, SH_LARGEST_OUTPUT); /* single precision: phi^15 of a stiff joint */
}

typedef struct {
    sh_column *column; /* NULL: they are only counted */
    int size;
} column_list;

static void add(column_list *list, const sh_parameters *p, int kind, int i, int j)
{
    const sh_real units[] = {1,
                             p->prior.tau_e,
                             p->prior.tau_e / p->range.phi,
                             p->prior.tau_coulomb,
                             p->prior.tau_coulomb > 0 ? 1 : 0,
                             (sh_real)sh_has_nominal_curve(p)};
    const void *in_unit = (const char *)p + sh_column_kinds[kind].prior;
    const sh_real prior = *(const sh_real *)in_unit * units[sh_column_kinds[kind].unit];

    if (!(prior > 0)) {
        return;
    }
    if (list->column != NULL) {
        sh_column *column = &list->column[list->size];

        column->kind = (short)kind;
        column->i = (short)i;
        column->j = (short)j;
        column->prior = prior;
        column->unit = sh_column_is(column, SH_IS_POWER) ? unit_of_power(p, i, j) : 0;
        column->place = width_or_place(column, p);
    }
    list->size += 1;
}

/* Lists first the columns of the spring, and behind them the other columns with their own filters. The columns of
 * friction are the last columns before the inertia, as bank.c requires.
 */
static void list_columns(const sh_parameters *p, column_list *list)
{
    const int n = p->rls.n, m = p->rls.m, linear = sh_torque_basis_linear(p->rls.symmetric);
    int i, j;

    /*@ loop unroll SH_MAX_M; */
    for (j = 0; j < m; ++j) {
        /*@ loop unroll SH_MAX_N; */
        for (i = 0; i < n; ++i) {
            add(list, p, SH_COLUMN_POWER, i, j);
        }
    }
    add(list, p, SH_COLUMN_NOMINAL, 0, 0);
    /*@ loop unroll 2; */
    for (i = 0; i < 2 && n + i < SH_MAX_N; ++i) {
        add(list, p, SH_COLUMN_HIGHER_POWER, n + i, 0);
    }
    if (m > 1 && m < SH_MAX_M && linear < n) {
        add(list, p, SH_COLUMN_SET_POWER, linear, m);
    }
    /*@ loop unroll SH_WIDTHS; */
    for (i = 0; i < SH_WIDTHS; ++i) {
        add(list, p, SH_COLUMN_DEAD_ZONE, i, 0);
    }
    /*@ loop unroll KNEES; */
    for (i = p->rls.symmetric ? RIGHT : AT_ZERO; i <= RIGHT; ++i) {
        add(list, p, p->range.knee > 0 ? SH_COLUMN_KNEE : SH_COLUMN_POSSIBLE_KNEE, i, 0);
    }
    /*@ loop unroll KNEES; */
    for (i = p->rls.symmetric ? SECOND_RIGHT : SECOND_LEFT; i < KNEES && p->range.knee_2 > 0; ++i) {
        add(list, p, SH_COLUMN_KNEE, i, 0);
    }
    add(list, p, SH_COLUMN_BIAS, 0, 0);
    add(list, p, SH_COLUMN_SIN_Q, 0, 0);
    add(list, p, SH_COLUMN_COS_Q, 0, 0);
    /*@ loop unroll SH_WIDTHS; */
    for (i = 0; i < SH_WIDTHS; ++i) {
        add(list, p, SH_COLUMN_HYSTERESIS, i, 0);
    }
    add(list, p, SH_COLUMN_DAMPING, 0, 0);
    if (m > 1) {
        add(list, p, SH_COLUMN_DAMPING, 0, m - 1);
    }
    /*@ loop unroll SH_COLUMN_KINDS; */
    for (i = SH_COLUMN_DELAY; i <= SH_COLUMN_INERTIA; ++i) {
        add(list, p, i, 0, 0);
    }
}

int sh_columns_count(const sh_parameters *p)
{
    column_list list = {NULL, 0};

    list_columns(p, &list);
    return list.size;
}

void sh_columns_start(sh_columns *columns, const sh_parameters *p)
{
    column_list list = {columns->column, 0};
    int i;

    list_columns(p, &list);
    columns->size = sh_columns_count(p);
    columns->has_nominal = sh_has_nominal_curve(p);
    columns->spring = columns->knees = columns->filtered = 0;
    columns->friction = columns->inertia = 0;
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < columns->size; ++i) {
        const int kind = columns->column[i].kind;

        columns->knees += kind < SH_COLUMN_DEAD_ZONE;
        columns->spring += kind < SH_COLUMN_BIAS;
        columns->filtered += kind < SH_COLUMN_DAMPING;
        columns->friction += kind < SH_COLUMN_LOAD;
        columns->inertia += kind < SH_COLUMN_INERTIA;
    }
}

/* ---- the signals of a sample ------------------------------------------------------------- */

/* max(x - k, 0) for a knee k >= 0, min(x - k, 0) for k < 0; if the torque is symmetric, both. */
static sh_real beyond_knee(sh_real x, sh_real k, int symmetric)
{
    const int is_left = symmetric ? x < 0 : k < 0;

    return is_left ? sh_fmin(x + sh_fabs(k), 0) : sh_fmax(x - k, 0);
}

/* Returns 1 for the widest dead zone. Only this dead zone may be a knee, and a knee changes the slope of the curve. */
static int may_be_knee(const sh_column *column)
{
    return column->kind == SH_COLUMN_DEAD_ZONE && column->i == SH_WIDTHS - 1;
}

/* Returns the input of a column's filter. Sets the derivative of this input by phi if the derivative is not 0. */
static sh_real signal_of(const sh_column *column, const sh_parameters *p, const sh_joint_point *at,
                         sh_real *slope)
{
    const int i = column->i, j = column->j;
    const sh_real h = column->place;
    sh_real beyond;

    switch (column->kind) {
    case SH_COLUMN_POWER:
    case SH_COLUMN_HIGHER_POWER:
    case SH_COLUMN_SET_POWER: /* l^j x^e / e, (F4) */
        *slope = at->slope[i] * at->l[j];
        return at->power[i] * at->l[j];
    case SH_COLUMN_NOMINAL:
        *slope = at->sigma_nominal;
        return at->tau_nominal;
    case SH_COLUMN_BIAS:
        return 1;
    case SH_COLUMN_SIN_Q:
        return sh_sin(at->q);
    case SH_COLUMN_COS_Q:
        return sh_cos(at->q);
    case SH_COLUMN_DEAD_ZONE: /* sh_limited(x, h) / h */
        if (may_be_knee(column) && sh_fabs(at->phi) < h * p->range.phi) {
            *slope = 1 / (h * p->range.phi);
        }
        return sh_limited(at->x, h) / h;
    case SH_COLUMN_HYSTERESIS: /* z / h, the element is z <- sh_limited(z + dphi, h) */
        return at->stop[i % SH_WIDTHS] / (h * p->range.phi);
    case SH_COLUMN_KNEE:
    case SH_COLUMN_POSSIBLE_KNEE:
        beyond = beyond_knee(at->x, h, p->rls.symmetric);
        *slope = sh_fabs(beyond) > 0 ? 1 / p->range.phi : 0;
        return beyond;
    default: /* signals.c gives its signal */
        return 0;
    }
}

/* Sets power = x^e / e and slope = x^(e - 1) / range for x = phi / range. For e = 0, power is 1, and slope is 0. */
static void set_powers(sh_joint_point *point, const sh_parameters *p, sh_real set_point)
{
    const int symmetric = p->rls.symmetric;
    const sh_real x = point->x;
    const sh_real l = (set_point - p->range.setPoint_center) / p->range.setPoint;
    const sh_real step = symmetric ? x * x : x, per_phi = 1 / p->range.phi;
    sh_real power = symmetric ? x : 1, slope = symmetric ? per_phi : 0;
    int i, j;

    /*@ loop unroll SH_MAX_N; */
    for (i = 0; i < SH_MAX_N; ++i) {
        const int e = sh_power_of_phi(symmetric, i);

        point->power[i] = e > 0 ? power / (sh_real)e : power;
        point->slope[i] = slope;
        power *= step;
        slope = e > 0 ? slope * step : per_phi;
    }
    point->l[0] = 1;
    /*@ loop unroll SH_MAX_M; */
    for (j = 1; j < SH_MAX_M; ++j) {
        point->l[j] = point->l[j - 1] * l;
    }
}

/* Computes torque and stiffness of the curve rls.eta_0, (21) and (23). */
static void set_nominal(sh_joint_point *point, const sh_parameters *p, sh_real set_point)
{
    const int n = p->rls.n, m = p->rls.m;
    sh_real F[SH_MAX_BASIS] = {0}, dF[SH_MAX_BASIS] = {0};
    int i, j;

    sh_torque_basis(p->rls.symmetric, n, m, set_point, point->phi, F, dF);
    for (i = 0; i < n; ++i) {
        for (j = 0; j < m; ++j) {
            point->tau_nominal += p->rls.eta_0[i][j] * F[j * n + i];
            point->sigma_nominal += p->rls.eta_0[i][j] * dF[j * n + i];
        }
    }
}

void sh_joint_point_at(sh_joint_point *point, const sh_columns *columns, const sh_parameters *p,
                       sh_real theta, sh_real q, sh_real phi, sh_real set_point,
                       const sh_real *stop)
{
    int i;

    point->theta = theta;
    point->q = q;
    point->phi = phi;
    point->x = phi / p->range.phi;
    point->stop = stop;
    set_powers(point, p, set_point);
    point->phi_set = phi * point->l[p->rls.m - 1];
    point->tau_nominal = point->sigma_nominal = 0;
    if (columns->has_nominal) {
        set_nominal(point, p, set_point);
    }
    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < SH_MAX_COLUMNS; ++i) { /* all are set */
        sh_real slope = 0;

        if (i >= columns->filtered) {
            point->F[i] = point->dF[i] = 0;
            continue;
        }
        point->F[i] = columns->column[i].prior * signal_of(&columns->column[i], p, point, &slope);
        point->dF[i] = columns->column[i].prior * slope;
    }
}

/* Returns 1 if x is near a change of the slope, so that x may be on the other side. The deformation at a knee is known
 * to 2 % of the range. The half width of a dead zone that may be a knee is known to a factor of 2.
 */
static int is_beside(const sh_column *column, const sh_parameters *p, sh_real x)
{
    const sh_real place = column->place;

    if (may_be_knee(column)) {
        return sh_fabs(x) > place / 2 && sh_fabs(x) < 2 * place;
    }
    return sh_fabs(x - place) < SH_PLACE_OF_KNEE ||
           (p->rls.symmetric && sh_fabs(x + place) < SH_PLACE_OF_KNEE);
}

sh_real sh_columns_judge_knees(const sh_columns *columns, const sh_parameters *p,
                               const sh_real *beta, sh_joint_point *at)
{
    sh_real variance = 0;
    int i;

    for (i = columns->knees; i < columns->spring; ++i) {
        const sh_column *column = &columns->column[i];

        if ((may_be_knee(column) || is_knee(column)) && sh_fabs(beta[i]) > 0) {
            const sh_real slope =
                at->sigma_nominal + sh_sum_of_products(at->dF, beta, columns->spring);
            const sh_real outside = slope - at->dF[i] * beta[i]; /* of a dead zone */
            const sh_real width = may_be_knee(column) ? column->place : 1;
            const sh_real jump = beta[i] * column->prior / p->range.phi / width;

            if (may_be_knee(column) && outside + jump < SH_GAP * outside) {
                at->dF[i] = 0;
            } else if (is_beside(column, p, at->x)) {
                variance += sh_square(jump / 2);
            }
        }
    }
    return variance;
}

void sh_columns_move_stops(sh_real *stop, const sh_parameters *p, sh_real change)
{
    int i;

    for (i = 0; i < SH_WIDTHS; ++i) {
        stop[i] = sh_limited(stop[i] + change, HYSTERESES[i] * p->range.phi);
    }
}

/* ---- the row ----------------------------------------------------------------------------- */

/* Returns H x + T^2/12 s^2 H x for a signal x that is not smooth (F5). */
static sh_real as_if_smooth(const sh_parameters *p, const sh_filtered *f, int i)
{
    return f->output[i] + p->samplePeriod * p->samplePeriod / 12 * f->second[i];
}

/* Returns the filtered torque in y: -gamma tau_f, or the measured torque of the spring [N.m]. */
static sh_real torque_in_y(const sh_parameters *p, const sh_filtered *f)
{
    return sh_is_measured(p) ? f->output[SH_FILTER_TORQUE]
                             : -p->motor.gamma * as_if_smooth(p, f, SH_FILTER_TORQUE);
}

/* gamma^2 (B theta'' + D_theta theta') of a filtered position i */
static sh_real motor_torque(const sh_parameters *p, const sh_filtered *f, int i)
{
    return p->motor.gamma * p->motor.gamma *
           (p->motor.B * f->second[i] + p->motor.D_theta * f->first[i]);
}

/* y = gamma^2 B theta''_f + gamma^2 D_theta theta'_f - gamma tau_f, or the torque of the spring */
sh_real sh_columns_y(const sh_parameters *p, const sh_filtered *f)
{
    return torque_in_y(p, f) + (sh_is_measured(p) ? 0 : motor_torque(p, f, SH_FILTER_THETA));
}

/* Returns sigma S + gamma^2 (D_theta S' + B S''), the error of y by the encoder error S of theta, which is signal i.
 * Returns 0 while sigma is not known (section 1).
 */
static sh_real encoder_error(const sh_filtered *f, const sh_feedback *feedback,
                             const sh_parameters *p, int i)
{
    const sh_real error = feedback->sigma * f->output[i] + motor_torque(p, f, i);

    return feedback->stiffness_known ? sh_limited(error, SH_LARGEST_ENCODER_ERROR) : 0;
}

/* Returns the entry of a column without a filter of its own, before the multiplication by the factor `prior`. */
static sh_real entry_of(const sh_column *column, const sh_filtered *f, const sh_feedback *feedback,
                        const sh_parameters *p)
{
    const sh_real gamma = p->motor.gamma, gain = sh_is_measured(p) ? 1 : -gamma;

    switch (column->kind) {
    case SH_COLUMN_DAMPING: /* (phi l^j)': as the stiffness, the damping may depend on the set-point */
        return f->first[column->j > 0 ? SH_FILTER_PHI_SET : SH_FILTER_PHI];
    case SH_COLUMN_LOAD: /* -|tau_e| s through the filter */
        return as_if_smooth(p, f, SH_FILTER_LOAD);
    case SH_COLUMN_DRIVE: /* -|gamma tau_f| s_f */
        return -sh_fabs(torque_in_y(p, f)) * as_if_smooth(p, f, SH_FILTER_SIGN);
    case SH_COLUMN_DELAY: /* gamma (tau' + delay tau''/2) */
        return -gain *
               (f->first[SH_FILTER_TORQUE] + feedback->delay / 2 * f->second[SH_FILTER_TORQUE]);
    case SH_COLUMN_REVERSAL: /* |gamma| s'_f */
        return sh_fabs(gamma) * f->first[SH_FILTER_SIGN];
    case SH_COLUMN_SIN_M:
        return encoder_error(f, feedback, p, SH_FILTER_SIN_M);
    case SH_COLUMN_COS_M:
        return encoder_error(f, feedback, p, SH_FILTER_COS_M);
    case SH_COLUMN_VISCOUS: /* -gamma^2 D_theta theta'_f */
        return -gamma * gamma * p->motor.D_theta * f->first[SH_FILTER_THETA];
    case SH_COLUMN_COULOMB: /* -|gamma| s_f */
        return -sh_fabs(gamma) * as_if_smooth(p, f, SH_FILTER_SIGN);
    case SH_COLUMN_INERTIA: /* -gamma^2 B theta''_f */
        return -gamma * gamma * p->motor.B * f->second[SH_FILTER_THETA];
    default:
        return 0;
    }
}

void sh_columns_row(const sh_columns *columns, const sh_mean *mean, const sh_feedback *feedback,
                    const sh_parameters *p, sh_real *x)
{
    const sh_filtered *f = &mean->filtered;
    const int size = columns->size, filtered = columns->filtered;
    int i;

    for (i = 0; i < filtered; ++i) {
        x[i] = mean->output[i];
    }
    for (; i < size; ++i) {
        const sh_column *column = &columns->column[i];
        const int is_motor = column->kind >= SH_COLUMN_REVERSAL;

        x[i] = sh_is_measured(p) && is_motor ? 0 : column->prior * entry_of(column, f, feedback, p);
    }
    x[size + SH_RIGHT_GAIN] = torque_in_y(p, f);
    x[size + SH_RIGHT_Y] = sh_columns_y(p, f) - f->output[SH_FILTER_NOMINAL];
}

/* (F14): nu = lambda epsilon / (1 - lambda c s'), s' = slope: estimated noise of the torque. The function removes this noise
 * from the column, and thus from the prediction. The remaining noise has the variance (1 - lambda) N_tau. This number
 * is also the covariance of the remaining noise and the torque in y.
 */
sh_real sh_columns_remove_noise(const sh_columns *columns, const sh_real *beta,
                                const sh_row_noise *noise, sh_real epsilon, sh_real *x,
                                sh_column_noise *left)
{
    const int i = sh_columns_place(columns, SH_COLUMN_DRIVE);
    const sh_real torque = x[columns->size + SH_RIGHT_GAIN];
    sh_real slope, c, nu, change;

    left->information = left->gain = 0;
    if (i < 0 || !(sh_square(torque) > 0)) {
        return 0;
    }
    slope = x[i] / torque;
    c = sh_limited(slope * beta[i], SH_LARGEST_RETURN);
    nu = noise->share * epsilon / (1 - noise->share * c);
    left->gain = (1 - noise->share) * noise->torque * slope;
    left->information = left->gain * slope;
    change = x[i] * (sh_fabs(1 - nu / torque) - 1);
    x[i] += change;
    return change * beta[i];
}
