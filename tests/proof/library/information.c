/* The functions of information.c that contracts.h replaces, with their contracts, for SH_MAX_COLUMNS columns. Every
 * array is as short as possible, and every loop is unrolled. Behind each array is a guard, which the functions must not
 * read or write.
 */
#include "anything.h"
#include "contracts.h"

static sh_real x[SH_MAX_ROW], v[SH_MAX_COLUMNS], c[SH_MAX_COLUMNS];

static void any_vectors(void)
{
    ANYTHING(x);
    ANYTHING(v);
    ANYTHING(c);
}

void columns(void)
{
    sh_information a, b;
    sh_last_row last;
    int i;

    ANYTHING(a.D);
    ANYTHING(a.U);
    ANYTHING(a.squares);
    a.size = SH_MAX_COLUMNS;
    any_vectors();
    sh_information_take(&a, x, any_real());
    sh_information_predict(&a, x, any_real());
    for (i = 0; i <= SH_MAX_COLUMNS; ++i) {
        sh_information_take_rows(&a, 0, i, x, any_real());
        sh_information_take_rows(&a, i, SH_MAX_COLUMNS, x, any_real());
    }
    sh_information_squares(&a, c);
    sh_information_forget(&a, any_real(), any_real());
    sh_information_drift(&a, v, any_real());
    last = sh_information_last(&a);
    sh_information_solve(&a, &last, v, c);
    sh_information_variances(&a, last.D, c, v);
    sh_information_set_last(&a, &last);
    for (i = 0; i < SH_MAX_COLUMNS; ++i) {
        sh_information_sample(&a, i, x);
    }
    sh_information_start(&b, SH_MAX_COLUMNS, any_real());
    sh_information_copy(&b, &a);
    //@ assert guards: !\initialized(&a.guard_D[0]) && !\initialized(&a.guard_U[0]);
    //@ assert guards: !\initialized(&b.guard_D[0]) && !\initialized(&b.guard_U[0]);
}

/* A number of columns that is smaller than the arrays allow, with rows that it has not: Eva does not recognise that the
 * row is one of the rows of the triangle.
 */
void rows(void)
{
    sh_information a;
    int size, i;

    for (size = 1; size <= SH_MAX_COLUMNS; ++size) {
        ANYTHING(a.D);
        ANYTHING(a.U);
        ANYTHING(a.squares);
        a.size = size;
        for (i = 0; i < SH_MAX_COLUMNS; ++i) {
            sh_information_sample(&a, i, x);
            sh_information_drift_sample(&a, i, any_real(), x);
            sh_information_restart(&a, i + 1, any_real());
            sh_information_take_rows(&a, 0, i + 1, x, any_real());
            sh_information_take_rows(&a, i + 1, SH_MAX_COLUMNS, x, any_real());
        }
    }
    //@ assert guards: !\initialized(&a.guard_D[0]) && !\initialized(&a.guard_U[0]);
}

/* A row of a triangle with any sample whose numbers are finite, also one that is removed, w < 0: the
 * entry of D stays positive.
 */
void positive(void)
{
    sh_information a;

    ANYTHING(a.U);
    ANYTHING(a.squares);
    any_vectors();
    a.size = 1;
    a.D[0] = (sh_real)Frama_C_float_interval(1e-38f, 1e37f);
    x[0] = (sh_real)Frama_C_float_interval(-1e9f, 1e9f);
    sh_information_take(&a, x, (sh_real)Frama_C_float_interval(-1e18f, 1e18f));
    //@ assert positive: a.D[0] > 0;
}
