#include "torque_basis.h"

void sh_torque_basis(int symmetric, int n, int m, sh_real set_point, sh_real phi, sh_real *F,
                     sh_real *dF)
{
    const sh_real step = symmetric ? phi * phi : phi; /* from one power to the next */
    sh_real l_power = 1;                              /* l^j */
    int i, j;

    for (j = 0; j < m; ++j) {
        sh_real lower = l_power; /* l^j phi^(e_i - 1), from the first i with e_i > 0 on */
        for (i = 0; i < n; ++i) {
            const int exponent = symmetric ? 2 * i + 1 : i;
            if (exponent == 0) {
                F[j * n + i] = l_power;
                dF[j * n + i] = 0;
                continue;
            }
            F[j * n + i] = lower * phi;
            dF[j * n + i] = (sh_real)exponent * lower;
            lower *= step;
        }
        l_power *= set_point;
    }
}
