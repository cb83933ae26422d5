#include "torque_basis.h"

void sh_torque_basis(int n, int m, double set_point, double phi, double *F, double *dF)
{
    const double phi_squared = phi * phi;
    double l_power = 1.0; /* l^j */
    int i, j;

    for (j = 0; j < m; ++j) {
        double even = l_power; /* l^j phi^(2i) */
        for (i = 0; i < n; ++i) {
            F[j * n + i] = even * phi;
            dF[j * n + i] = (2 * i + 1) * even;
            even *= phi_squared;
        }
        l_power *= set_point;
    }
}
