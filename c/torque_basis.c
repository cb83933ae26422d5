#include "torque_basis.h"

void sh_torque_basis(int symmetric, int n, int m, sh_real set_point, sh_real phi,
                     sh_real *restrict F, sh_real *restrict dF)
{
    const sh_real step = symmetric ? phi * phi : phi; /* from one power to the next */
    sh_real lower = 1;                                /* phi^(exponent - 1) */
    sh_real exponent = 1;                             /* of the first i with an exponent above 0 */
    int i = 0, j;

    if (!symmetric) {
        F[0] = 1;
        dF[0] = 0;
        i = 1;
    }
    for (; i < n; ++i) {
        F[i] = lower * phi;
        dF[i] = exponent * lower;
        lower *= step;
        exponent += symmetric ? 2 : 1;
    }
    for (j = 1; j < m; ++j) { /* from l^(j-1) to l^j */
        for (i = 0; i < n; ++i) {
            F[j * n + i] = F[(j - 1) * n + i] * set_point;
            dF[j * n + i] = dF[(j - 1) * n + i] * set_point;
        }
    }
}

int sh_torque_basis_linear(int symmetric)
{
    return symmetric ? 0 : 1;
}
