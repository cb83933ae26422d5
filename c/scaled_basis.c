#include "scaled_basis.h"

/* Power of phi that belongs to coefficient i. */
static int power(int symmetric, int i)
{
    return symmetric ? 2 * i + 1 : i;
}

void sh_scaled_basis(const sh_range_parameters *range, int symmetric, int n, int m,
                     double set_point, double phi, double *F, double *dF)
{
    int i, j;

    sh_torque_basis(symmetric, n, m, set_point / range->setPoint, phi / range->phi, F, dF);
    for (i = 0; i < n; ++i) {
        const double e = power(symmetric, i) > 0 ? power(symmetric, i) : 1.0;
        for (j = 0; j < m; ++j) {
            F[j * n + i] /= e;
            dF[j * n + i] /= e * range->phi;
        }
    }
}

void sh_scaled_basis_units(const sh_range_parameters *range, int symmetric, int n, int m,
                           double *units)
{
    double of_l = 1.0;
    int i, j, k;

    for (j = 0; j < m; ++j) {
        for (i = 0; i < n; ++i) {
            const int e = power(symmetric, i);
            double unit = e > 0 ? of_l * e : of_l;
            for (k = 0; k < e; ++k)
                unit *= range->phi;
            units[j * n + i] = unit;
        }
        of_l *= range->setPoint;
    }
}
