#include "torque_basis.h"

void sh_torque_basis(int symmetric, int n, int m, sh_real set_point, sh_real phi, sh_real *F,
                     sh_real *dF)
{
    const sh_real step = symmetric ? phi * phi : phi; /* from one power to the next */
    const int size = n * m;
    sh_real lower = 1; /* phi^(e_i - 1), from the first i with e_i > 0 on */
    int i;

    for (i = 0; i < n; ++i) {
        const int exponent = symmetric ? 2 * i + 1 : i;

        if (exponent == 0) {
            F[i] = 1;
            dF[i] = 0;
            continue;
        }
        F[i] = lower * phi;
        dF[i] = (sh_real)exponent * lower;
        lower *= step;
    }
    for (; i < size; ++i) { /* from l^j to l^(j+1) */
        F[i] = F[i - n] * set_point;
        dF[i] = dF[i - n] * set_point;
    }
}

int sh_torque_basis_linear(int symmetric)
{
    return symmetric ? 0 : 1;
}
