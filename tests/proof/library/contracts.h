/* Contracts of the functions that work on triangles. With them, a tick is analysed without the loops over all
 * entries, and for any numbers. The programs information.c and ud_factor.c of this folder analyse the replaced
 * functions.
 *
 * Each \from names all that the requirements read: Eva reuses the results of a function for calls that read the same
 * values.
 *
 * The last two are about parameters that passed sh_parameters_check, which calls the same functions with them. There
 * are 1..SH_MAX_COLUMNS columns, and a curve rls.eta_0 if prior.tau_e is 0.
 */
#ifndef CONTRACTS_H
#define CONTRACTS_H

#include "information.h"
#include "regression.h"
#include "ud_factor.h"

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires \valid(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    requires \initialized(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    assigns \result, a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1], a->squares,
            x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1]
            \from *a, x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1], w;
*/
sh_real sh_information_take(sh_information *a, sh_real *x, sh_real w);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires 0 <= first <= SH_MAX_COLUMNS && 0 <= end <= SH_MAX_COLUMNS;
    requires \valid(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    requires \initialized(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    assigns \result, a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1], a->squares,
            x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1]
            \from *a, first, end, x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1], w;
*/
sh_real sh_information_take_rows(sh_information *a, int first, int end, sh_real *x, sh_real w);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires \valid(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    requires \initialized(x + (0 .. a->size + SH_RIGHT_SIDES - 1));
    assigns \result, x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1]
            \from *a, x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1], w;
*/
sh_real sh_information_predict(const sh_information *a, sh_real *x, sh_real w);

/*@ requires 1 <= size <= SH_MAX_COLUMNS;
    assigns a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1], a->squares \from precision;
    assigns a->size \from size;
    ensures a->size == size;
*/
void sh_information_start(sh_information *a, int size, sh_real precision);

/*@ requires 1 <= from->size <= SH_MAX_COLUMNS;
    assigns to->size, to->squares, to->D[0 .. SH_MAX_COLUMNS - 1], to->U[0 .. SH_MAX_TRIANGLE - 1]
            \from *from;
    ensures 1 <= to->size <= SH_MAX_COLUMNS;
*/
void sh_information_copy(sh_information *to, const sh_information *from);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires 0 <= count <= SH_MAX_COLUMNS;
    assigns a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1] \from *a, count, precision;
*/
void sh_information_restart(sh_information *a, int count, sh_real precision);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires 0 <= i < SH_MAX_COLUMNS;
    assigns \result, x[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1] \from *a;
*/
sh_real sh_information_sample(const sh_information *a, int i, sh_real *x);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    assigns \result \from *a;
*/
sh_last_row sh_information_last(const sh_information *a);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    assigns a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1] \from *a, *last;
*/
void sh_information_set_last(sh_information *a, const sh_last_row *last);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    assigns beta[0 .. SH_MAX_COLUMNS - 1], per_gain[0 .. SH_MAX_COLUMNS - 1] \from *a, *last;
*/
void sh_information_solve(const sh_information *a, const sh_last_row *last, sh_real *beta,
                          sh_real *per_gain);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires \initialized(first + (0 .. a->size - 1));
    requires \initialized(second + (0 .. a->size - 1));
    assigns \result, first[0 .. SH_MAX_COLUMNS - 1], second[0 .. SH_MAX_COLUMNS - 1]
            \from *a, last_D, first[0 .. SH_MAX_COLUMNS - 1], second[0 .. SH_MAX_COLUMNS - 1];
*/
sh_variances sh_information_variances(const sh_information *a, sh_real last_D, sh_real *first,
                                      sh_real *second);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires \initialized(beta + (0 .. a->size - 1));
    assigns \result \from *a, beta[0 .. SH_MAX_COLUMNS - 1];
*/
sh_real sh_information_squares(const sh_information *a, const sh_real *beta);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires \initialized(v + (0 .. a->size - 1));
    assigns \result, a->D[0 .. SH_MAX_COLUMNS - 1], a->U[0 .. SH_MAX_TRIANGLE - 1], a->squares
            \from *a, v[0 .. SH_MAX_COLUMNS - 1], c;
*/
sh_real sh_information_drift(sh_information *a, const sh_real *v, sh_real c);

/*@ requires 1 <= a->size <= SH_MAX_COLUMNS;
    requires 0 <= k < SH_MAX_COLUMNS;
    assigns \result, row[0 .. SH_MAX_COLUMNS + SH_RIGHT_SIDES - 1] \from *a, k, c;
*/
sh_real sh_information_drift_sample(const sh_information *a, int k, sh_real c, sh_real *row);

/*@ requires 1 <= size <= SH_MAX_PARAMETERS;
    assigns P->D[0 .. SH_MAX_ROWS - 1], P->U[0 .. SH_MAX_U - 1], P->work, P->least \from P_0;
    assigns P->size \from size;
    ensures P->size == size;
    ensures \initialized(&P->D[0 .. SH_MAX_ROWS - 1]);
*/
void sh_ud_factor_start(sh_ud_factor *P, int size, sh_real P_0);

/*@ requires 1 <= P->size <= SH_MAX_PARAMETERS;
    requires \initialized(F + (0 .. P->size - 1));
    assigns \result, P->work \from *P, F[0 .. SH_MAX_ROWS - 1];
*/
sh_real sh_ud_factor_project(sh_ud_factor *P, const sh_real *F);

/*@ requires 1 <= P->size <= SH_MAX_PARAMETERS;
    assigns P->D[0 .. SH_MAX_ROWS - 1], P->U[0 .. SH_MAX_U - 1], P->work, P->least \from *P, w;
    assigns \result \from P, *P;
    ensures \result == P->work.g;
*/
const sh_real *sh_ud_factor_update(sh_ud_factor *P, sh_real w);

/*@ requires 1 <= P->size <= SH_MAX_PARAMETERS;
    requires \initialized(F + (0 .. P->size - 1));
    assigns \result \from *P, F[0 .. SH_MAX_ROWS - 1];
*/
sh_real sh_ud_factor_variance(const sh_ud_factor *P, const sh_real *F);

/*@ assigns \result \from *p;
    ensures 1 <= \result <= SH_MAX_COLUMNS;
*/
int sh_columns_count(const sh_parameters *p);

/*@ assigns \result \from *p;
    ensures \result == 0 || \result == 1;
    ensures PROOF_CURVE == 0 ==> \result == 1;
*/
int sh_has_nominal_curve(const sh_parameters *p);

#endif
