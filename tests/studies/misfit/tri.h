/* Least squares in the information form, without square roots (Gentleman 1974, AS 75; Miller 1992,
 * AS 274): sum w x x' = U' D U with U unit upper triangular, and the right-hand sides U z.
 *
 * A row is taken in O(n^2). Weights scale D alone. D[i] is the information about parameter i if the
 * parameters before it are estimated too and those after it are exact. To leave out the last
 * columns is to truncate.
 */
#ifndef TRI_H
#define TRI_H

#include "sigmahat.h"

#ifndef TRI_MAX
#define TRI_MAX 44 /* largest number of columns */
#endif
enum { TRI_SIDES = 2, TRI_U = TRI_MAX * (TRI_MAX - 1) / 2 + TRI_SIDES * TRI_MAX };

typedef struct {
    int n;
    sh_real D[TRI_MAX];
    sh_real U[TRI_U]; /* row i: columns i + 1 .. n - 1, then the right-hand sides */
    sh_real rest;     /* sum of squares that no parameter explains, of the last side */
} tri;

/* Starts with n parameters of the given precision, and the estimate 0. */
void tri_start(tri *t, int n, sh_real precision);
/* Takes a row x [size: n + TRI_SIDES], which is used up; w may be negative if U'DU stays definite.
 */
void tri_take(tri *t, sh_real *x, sh_real w);
/* First entry of row i of U: that of column i + 1. */
sh_real *tri_row(tri *t, int i);
/* Solution for a right-hand side [size: n]. */
void tri_solve(tri *t, int side, sh_real *beta);
/* v = U^-T c [size: n]. Then c' solution = sum v z, variance of c'beta = sum v^2 / D. */
void tri_project(tri *t, const sh_real *c, sh_real *v);
/* Sum of squares of what the rows so far leave at beta. */
sh_real tri_squares(tri *t, const sh_real *beta);
#endif
