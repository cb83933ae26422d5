/* Contracts of the functions that work on triangles. With them, a tick is analysed without the loops over all
 * entries, and for any numbers. The programs information.c and least_squares.c of this folder analyse the replaced
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
#include "least_squares.h"
#include "regression.h"

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
    requires eta_0 == \null || \initialized(eta_0 + (0 .. size - 1));
    assigns rls->eta[0 .. SH_MAX_ROWS - 1], rls->eta_low[0 .. SH_MAX_ROWS - 1]
            \from eta_0[0 .. SH_MAX_PARAMETERS - 1], size;
    assigns rls->P.columns[0 .. SH_MAX_ROWS - 1], rls->P.U[0 .. SH_MAX_U - 1],
            rls->P.PF[0 .. SH_MAX_ROWS - 1], rls->P.least \from P_0, size;
    assigns rls->P.size \from size;
    ensures rls->P.size == size;
    ensures \initialized(&rls->eta[0 .. SH_MAX_ROWS - 1]);
    ensures \initialized(&rls->eta_low[0 .. SH_MAX_ROWS - 1]);
*/
void sh_least_squares_start(sh_least_squares *rls, int size, const sh_real *eta_0, sh_real P_0);

/*@ requires 1 <= rls->P.size <= SH_MAX_PARAMETERS;
    requires \initialized(F + (0 .. rls->P.size - 1));
    assigns \result, *innovation, rls->eta[0 .. SH_MAX_ROWS - 1], rls->eta_low[0 .. SH_MAX_ROWS - 1],
            rls->P.columns[0 .. SH_MAX_ROWS - 1], rls->P.U[0 .. SH_MAX_U - 1],
            rls->P.PF[0 .. SH_MAX_ROWS - 1], rls->P.least
            \from *rls, kind, factor, F[0 .. SH_MAX_PARAMETERS - 1], y;
    ensures \result == 0 || \result == 1;
    ensures \result == 1 ==> \initialized(innovation);
*/
int sh_least_squares_update(sh_least_squares *rls, int kind, sh_real factor, const sh_real *F,
                            sh_real y, sh_innovation *innovation);

/*@ requires 1 <= rls->P.size <= SH_MAX_PARAMETERS;
    requires \initialized(F + (0 .. rls->P.size - 1));
    assigns \result \from *rls, F[0 .. SH_MAX_PARAMETERS - 1];
*/
sh_real sh_least_squares_variance(const sh_least_squares *rls, const sh_real *F);

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
