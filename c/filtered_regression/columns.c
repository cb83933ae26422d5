#include "columns.h"

#include <stddef.h>

#include "real_math.h"
#include "scalar_product.h"
#include "scaled_basis.h"
#include "state_variable_filter.h"
#include "torque_basis.h"

/* Half widths of dead zones and of plays, in units of range.phi. They do not follow the range that
 * the deformation has covered, so that the columns are the same for all samples.
 */
static const sh_real GAPS[SH_PLAYS] = {(sh_real)0.01, (sh_real)0.04, (sh_real)0.16};
static const sh_real PLAYS[SH_PLAYS] = {(sh_real)0.005, (sh_real)0.02, (sh_real)0.08};

enum { ALWAYS = 0, POWERS, SET_POWER, GAP, HYSTERESIS, MOTOR_ENCODER };

static const struct {
    int group, is_torque, is_of_equation, signal;
} TRAITS[SH_COLUMN_KINDS] = {
    [SH_COLUMN_BASIS] = {ALWAYS, 1, 1, SH_SIGNAL_LINEAR},
    [SH_COLUMN_NOMINAL] = {ALWAYS, 1, 1, SH_SIGNAL_NONE},
    [SH_COLUMN_BIAS] = {ALWAYS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_DAMPING] = {ALWAYS, 0, 0, SH_SIGNAL_STEADY},
    [SH_COLUMN_SIN_Q] = {ALWAYS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_COS_Q] = {ALWAYS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_LOAD] = {ALWAYS, 0, 0, SH_SIGNAL_MEAN},
    [SH_COLUMN_DRIVE] = {ALWAYS, 0, 0, SH_SIGNAL_NONE},
    [SH_COLUMN_DELAY] = {ALWAYS, 0, 0, SH_SIGNAL_NONE},
    [SH_COLUMN_REVERSAL] = {ALWAYS, 0, 0, SH_SIGNAL_NONE},
    [SH_COLUMN_POWER] = {POWERS, 1, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_SET_POWER] = {SET_POWER, 1, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_GAP_1] = {GAP, 1, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_GAP_2] = {GAP, 1, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_GAP_3] = {GAP, 1, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_PLAY_1] = {HYSTERESIS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_PLAY_2] = {HYSTERESIS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_PLAY_3] = {HYSTERESIS, 0, 0, SH_SIGNAL_LINEAR},
    [SH_COLUMN_SIN_M] = {MOTOR_ENCODER, 0, 0, SH_SIGNAL_STEADY},
    [SH_COLUMN_COS_M] = {MOTOR_ENCODER, 0, 0, SH_SIGNAL_STEADY},
    [SH_COLUMN_VISCOUS] = {ALWAYS, 0, 1, SH_SIGNAL_NONE},
    [SH_COLUMN_COULOMB] = {ALWAYS, 0, 1, SH_SIGNAL_NONE},
    [SH_COLUMN_INERTIA] = {ALWAYS, 0, 1, SH_SIGNAL_NONE},
};

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

int sh_column_group(const sh_column *column)
{
    return TRAITS[column->kind].group;
}

int sh_column_is_torque(const sh_column *column)
{
    return TRAITS[column->kind].is_torque;
}

int sh_column_is_gap(const sh_column *column)
{
    return TRAITS[column->kind].group == GAP;
}

int sh_column_is_of_equation(const sh_column *column)
{
    return TRAITS[column->kind].is_of_equation;
}

int sh_column_signal(const sh_column *column)
{
    return TRAITS[column->kind].signal;
}

/* ---- which columns there are ------------------------------------------------------------- */

/* A list of columns that is filled, or only counted. */
typedef struct {
    sh_column *column; /* NULL: counted */
    int size;
} column_list;

static void add_as(column_list *list, int kind, int index, sh_real prior, sh_real unit)
{
    if (!(prior > 0)) {
        return;
    }
    if (list->column != NULL) {
        sh_column *column = list->column + list->size;

        column->kind = kind;
        column->index = index;
        column->prior = prior;
        column->unit = unit;
    }
    list->size += 1;
}

static void add(column_list *list, int kind, sh_real prior)
{
    add_as(list, kind, 0, prior, 0);
}

/* The product of powers whose coefficient is eta[i][j]. */
static void add_powers(column_list *list, int kind, const sh_parameters *p, int i, int j,
                       sh_real prior)
{
    add_as(list, kind, i * SH_MAX_M + j, prior,
           sh_scaled_basis_unit(&p->range, p->rls.symmetric, i, j));
}

/* Those of the torque that are always used, then others, then the motor's. */
static void list_columns(const sh_parameters *p, column_list *list)
{
    const sh_prior_parameters *prior = &p->prior;
    const sh_real tau_e = prior->tau_e, K_0 = tau_e / p->range.phi;
    const int n = p->rls.n, m = p->rls.m, linear = sh_torque_basis_linear(p->rls.symmetric);
    int i, j;

    /*@ loop unroll SH_MAX_M; */
    for (j = 0; j < m; ++j) {
        /*@ loop unroll SH_MAX_N; */
        for (i = 0; i < n; ++i) {
            add_powers(list, SH_COLUMN_BASIS, p, i, j, tau_e);
        }
    }
    add(list, SH_COLUMN_NOMINAL, sh_has_nominal_curve(p) ? prior->nominal : 0);
    add(list, SH_COLUMN_BIAS, prior->bias * tau_e);
    add(list, SH_COLUMN_DAMPING, prior->damping * K_0);
    if (m > 1) {
        add_as(list, SH_COLUMN_DAMPING, m - 1, prior->damping * K_0, 0);
    }
    add(list, SH_COLUMN_SIN_Q, prior->eccentric * K_0);
    add(list, SH_COLUMN_COS_Q, prior->eccentric * K_0);
    add(list, SH_COLUMN_LOAD, prior->load_friction);
    if (prior->tau_coulomb > 0) { /* else the motor has no dry friction */
        add(list, SH_COLUMN_DRIVE, prior->load_friction);
    }
    add(list, SH_COLUMN_DELAY, prior->delay);
    add(list, SH_COLUMN_REVERSAL, prior->reversal * prior->tau_coulomb);
    /*@ loop unroll 2; */
    for (i = 0; i < 2 && n + i < SH_MAX_N; ++i) {
        add_powers(list, SH_COLUMN_POWER, p, n + i, 0, prior->power * tau_e);
    }
    if (m > 1 && m < SH_MAX_M && linear < n) {
        add_powers(list, SH_COLUMN_SET_POWER, p, linear, m, prior->power * tau_e);
    }
    /*@ loop unroll SH_PLAYS; */
    for (i = 0; i < SH_PLAYS; ++i) {
        add(list, SH_COLUMN_GAP_1 + i, prior->gap * tau_e);
    }
    /*@ loop unroll SH_PLAYS; */
    for (i = 0; i < SH_PLAYS; ++i) {
        add(list, SH_COLUMN_PLAY_1 + i, prior->hysteresis * tau_e);
    }
    add(list, SH_COLUMN_SIN_M, prior->eccentric_motor);
    add(list, SH_COLUMN_COS_M, prior->eccentric_motor);
    add(list, SH_COLUMN_VISCOUS, prior->D_theta);
    add(list, SH_COLUMN_COULOMB, prior->tau_coulomb);
    add(list, SH_COLUMN_INERTIA, prior->B);
}

int sh_columns_count(const sh_parameters *p)
{
    column_list list = {NULL, 0};

    list_columns(p, &list);
    return list.size;
}

void sh_columns_list(const sh_parameters *p, sh_column *column)
{
    column_list list = {column, 0};

    list_columns(p, &list);
}

void sh_columns_start(sh_regression_state *state, const sh_parameters *p)
{
    const int n = p->rls.n, m = p->rls.m;
    int i, j;

    sh_columns_list(p, state->column);
    state->size = sh_columns_count(p);
    state->has_nominal = sh_has_nominal_curve(p);
    for (j = 0; j < m; ++j) {
        for (i = 0; i < n; ++i) {
            state->nominal_curve[j * n + i] =
                p->rls.eta_0[i][j] / sh_scaled_basis_unit(&p->range, p->rls.symmetric, i, j);
        }
    }
}

int sh_column_can_join(const sh_regression_state *state, const sh_parameters *p,
                       const sh_column *column, int group)
{
    /* What is wider than a quarter of the covered range looks like the spring. */
    const sh_real covered = (state->history.phi_max - state->history.phi_min) / 4 / p->range.phi;
    const int kind = column->kind;

    if (sh_column_group(column) != group) {
        return 0;
    }
    switch (kind) {
    case SH_COLUMN_GAP_1:
    case SH_COLUMN_GAP_2:
    case SH_COLUMN_GAP_3:
        return GAPS[kind - SH_COLUMN_GAP_1] < covered;
    case SH_COLUMN_PLAY_1:
    case SH_COLUMN_PLAY_2:
    case SH_COLUMN_PLAY_3:
        return PLAYS[kind - SH_COLUMN_PLAY_1] < covered;
    default:
        return 1;
    }
}

/* ---- signals before the filter ----------------------------------------------------------- */

static sh_real clip(sh_real x, sh_real limit)
{
    return sh_fmin(sh_fmax(x, -limit), limit);
}

void sh_columns_move_plays(sh_regression_state *state, const sh_parameters *p, sh_real change)
{
    int i;

    for (i = 0; i < SH_PLAYS; ++i) {
        state->history.play[i] = clip(state->history.play[i] + change, PLAYS[i] * p->range.phi);
    }
}

/* What the signals depend on. */
typedef struct {
    sh_real theta, q, phi, x, l; /* x and l: deformation and set-point over their ranges */
} joint_point;

/* Signal of a column, and its slope over phi. */
static sh_real input_of(const sh_regression_state *state, const sh_parameters *p,
                        const sh_column *column, const joint_point *at, sh_real *slope)
{
    const int kind = column->kind;
    const int i = column->index / SH_MAX_M, j = column->index % SH_MAX_M; /* of powers */
    int e;

    *slope = 0;
    switch (kind) {
    case SH_COLUMN_BASIS:
        *slope = state->work.slope[j * p->rls.n + i];
        return state->work.basis[j * p->rls.n + i];
    case SH_COLUMN_NOMINAL:
        *slope = state->sigma_nominal;
        return state->tau_nominal;
    case SH_COLUMN_BIAS:
        return 1;
    case SH_COLUMN_DAMPING: /* as the stiffness, it may depend on the set-point */
        return at->phi * sh_power(at->l, column->index);
    case SH_COLUMN_SIN_Q:
        return sh_sin(at->q);
    case SH_COLUMN_COS_Q:
        return sh_cos(at->q);
    case SH_COLUMN_POWER:
        e = sh_scaled_basis_power(p->rls.symmetric, i);
        *slope = sh_power(at->x, e - 1) / p->range.phi;
        return sh_power(at->x, e) / (sh_real)e;
    case SH_COLUMN_SET_POWER:
        *slope = sh_power(at->l, p->rls.m) / p->range.phi;
        return at->x * sh_power(at->l, p->rls.m);
    case SH_COLUMN_GAP_1: /* no slope: sigma is that of the spring where it is engaged */
    case SH_COLUMN_GAP_2:
    case SH_COLUMN_GAP_3:
        return clip(at->x, GAPS[kind - SH_COLUMN_GAP_1]) / GAPS[kind - SH_COLUMN_GAP_1];
    case SH_COLUMN_PLAY_1:
    case SH_COLUMN_PLAY_2:
    case SH_COLUMN_PLAY_3:
        return state->history.play[kind - SH_COLUMN_PLAY_1] /
               (PLAYS[kind - SH_COLUMN_PLAY_1] * p->range.phi);
    case SH_COLUMN_SIN_M:
        return sh_sin(p->motor.gamma * at->theta);
    case SH_COLUMN_COS_M:
        return sh_cos(p->motor.gamma * at->theta);
    default:
        return 0;
    }
}

void sh_columns_input(sh_regression_state *state, const sh_parameters *p, sh_real theta, sh_real q,
                      sh_real phi, sh_real set_point)
{
    const joint_point at = {theta, q, phi, phi / p->range.phi, set_point / p->range.setPoint};
    int i;

    sh_scaled_basis(&p->range, p->rls.symmetric, p->rls.n, p->rls.m, set_point, phi,
                    state->work.basis, state->work.slope);
    if (state->has_nominal) {
        sh_scalar_products(state->nominal_curve, state->work.basis, state->work.slope,
                           p->rls.n * p->rls.m, &state->tau_nominal, &state->sigma_nominal);
    }
    for (i = 0; i < state->size; ++i) {
        const sh_column *column = &state->column[i];
        sh_real slope;

        state->work.F[i] = column->prior * input_of(state, p, column, &at, &slope);
        state->work.dF[i] = column->prior * slope;
    }
}

/* ---- row of the regression --------------------------------------------------------------- */

/* Output of the filter of a signal that is not smooth. The filter treats theta and the columns of
 * the torque as linear between samples although they are smooth, which reduces them by the share
 * (Omega T)^2 / 12 at the frequency Omega. The torque and the sign are treated exactly.
 * T^2 / 12 s^2 reduces them by the same share, so that the equation between all signals holds.
 */
static sh_real as_if_smooth(const sh_state_variable_filter *filter, const sh_filter_design *design)
{
    return sh_state_variable_filter_output(filter) +
           design->T * design->T / 12 * sh_state_variable_filter_second(filter, design);
}

/* What the entries of the motor consist of; all 0 where the torque is measured. */
typedef struct {
    sh_real viscous, inertial; /* gamma^2 D_theta theta'_f, gamma^2 B theta''_f [N.m] */
    sh_real gain;              /* y contains the torque times this: -gamma, or 1 if measured */
    int is_measured;
} motor_terms;

static motor_terms motor_terms_of(const sh_regression_state *state, const sh_parameters *p)
{
    const sh_motor_parameters *motor = &p->motor;
    const sh_real gamma2 = motor->gamma * motor->gamma;
    motor_terms terms = {0, 0, 1, sh_is_measured(p)};

    if (terms.is_measured) {
        return terms;
    }
    terms.gain = -motor->gamma;
    terms.viscous =
        gamma2 * motor->D_theta * sh_state_variable_filter_first(&state->theta, &state->design);
    terms.inertial =
        gamma2 * motor->B * sh_state_variable_filter_second(&state->theta, &state->design);
    return terms;
}

/* Filtered torque in y [N.m]. */
static sh_real filtered_torque(const sh_regression_state *state, const motor_terms *motor)
{
    return motor->gain * (motor->is_measured ? sh_state_variable_filter_output(&state->torque)
                                             : as_if_smooth(&state->torque, &state->design));
}

/* Friction by a torque of the motor behind the gear, filtered [N.m]. */
static sh_real drive_friction(const sh_regression_state *state, sh_real torque)
{
    return -sh_fabs(torque) * as_if_smooth(&state->friction, &state->design);
}

/* A stiffness that is wrong by many orders must not make the row too large to be learned from: then
 * every sample would be refused, and the stiffness would never be corrected.
 */
static const sh_real LARGEST_ENCODER_ERROR = SH_FOR(SH_REAL, 1e74, 1e14f); /* [N.m] */

/* Error of y by an encoder of the motor that is wrong by the signal of a filter [N.m]. */
static sh_real encoder_error(const sh_regression_state *state, const sh_parameters *p,
                             const sh_state_variable_filter *filter)
{
    const sh_motor_parameters *motor = &p->motor;
    const sh_filter_design *design = &state->design;

    return state->sigma * sh_state_variable_filter_output(filter) +
           motor->gamma * motor->gamma *
               (motor->D_theta * sh_state_variable_filter_first(filter, design) +
                motor->B * sh_state_variable_filter_second(filter, design));
}

/* Entry of a column in the row. */
static sh_real entry_of(const sh_regression_state *state, const sh_parameters *p,
                        const motor_terms *motor, const sh_column *column,
                        const sh_state_variable_filter *filter)
{
    const sh_filter_design *design = &state->design;
    const sh_real prior = column->prior, gamma = sh_fabs(p->motor.gamma);

    switch (column->kind) {
    case SH_COLUMN_NOMINAL:
        return prior * sh_state_variable_filter_output(&state->nominal);
    case SH_COLUMN_DAMPING:
        return sh_state_variable_filter_first(filter, design);
    case SH_COLUMN_DELAY:
        return -prior * motor->gain *
               (sh_state_variable_filter_first(&state->torque, design) +
                state->delay / 2 * sh_state_variable_filter_second(&state->torque, design));
    case SH_COLUMN_LOAD:
        return motor->is_measured ? 0 : as_if_smooth(filter, design);
    case SH_COLUMN_DRIVE:
        return motor->is_measured ? 0
                                  : prior * drive_friction(state, filtered_torque(state, motor));
    case SH_COLUMN_REVERSAL:
        return motor->is_measured
                   ? 0
                   : prior * gamma * sh_state_variable_filter_first(&state->friction, design);
    case SH_COLUMN_SIN_M:
    case SH_COLUMN_COS_M: /* prior is already in the signal */
        return motor->is_measured || !state->stiffness_known
                   ? 0
                   : sh_limited(encoder_error(state, p, filter), LARGEST_ENCODER_ERROR);
    case SH_COLUMN_VISCOUS:
        return -prior * motor->viscous;
    case SH_COLUMN_COULOMB:
        return motor->is_measured ? 0 : -prior * gamma * as_if_smooth(&state->friction, design);
    case SH_COLUMN_INERTIA:
        return -prior * motor->inertial;
    default:
        return sh_state_variable_filter_output(filter);
    }
}

sh_real sh_columns_row(const sh_regression_state *state, const sh_parameters *p, sh_real *x)
{
    const motor_terms motor = motor_terms_of(state, p);
    const sh_real torque = filtered_torque(state, &motor);
    const sh_real y = motor.inertial + motor.viscous + torque;
    int i;

    for (i = 0; i < state->size; ++i) {
        x[i] = entry_of(state, p, &motor, &state->column[i], &state->filter[i]);
    }
    x[state->size + SH_SIDE_GAIN] = torque;
    x[state->size + SH_SIDE_Y] = y;
    if (state->has_nominal) {
        x[state->size + SH_SIDE_Y] -= sh_state_variable_filter_output(&state->nominal);
    }
    return y;
}

sh_real sh_columns_remove_noise(const sh_regression_state *state, const sh_parameters *p,
                                sh_real noise, sh_real *x)
{
    const sh_real torque = x[state->size + SH_SIDE_GAIN];
    sh_real change = 0;
    int i;

    for (i = 0; i < state->size; ++i) {
        if (state->column[i].kind == SH_COLUMN_DRIVE && !sh_is_measured(p)) {
            const sh_real entry = state->column[i].prior * drive_friction(state, torque - noise);

            change += (entry - x[i]) * state->beta[i];
            x[i] = entry;
        }
    }
    return change;
}

/* ---- what the estimate means ------------------------------------------------------------- */

sh_real sh_columns_torque(const sh_regression_state *state)
{
    sh_real torque = state->tau_nominal;
    int i;

    for (i = 0; i < state->size; ++i) {
        if (sh_column_is_torque(&state->column[i])) {
            torque += state->work.F[i] * state->beta[i];
        }
    }
    return torque;
}
