#include "scaled_basis.h"

#include "real_math.h"

int sh_scaled_basis_power(int symmetric, int i)
{
    return symmetric ? 2 * i + 1 : i;
}

void sh_scaled_basis(const sh_range_parameters *range, int symmetric, int n, int m,
                     sh_real set_point, sh_real phi, sh_real *F, sh_real *dF)
{
    const sh_real x = phi / range->phi, step = symmetric ? x * x : x;
    const sh_real l = set_point / range->setPoint;
    sh_real upper = symmetric ? x : 1;              /* x^e */
    sh_real slope = symmetric ? 1 / range->phi : 0; /* x^(e - 1) / range, 0 for e = 0 */
    int i, j;

    for (i = 0; i < n; ++i) {
        const int e = sh_scaled_basis_power(symmetric, i);
        sh_real of_F = e > 0 ? upper / (sh_real)e : upper, of_dF = slope;

        for (j = 0; j < m; ++j) {
            F[j * n + i] = of_F;
            dF[j * n + i] = of_dF;
            of_F *= l;
            of_dF *= l;
        }
        upper *= step;
        slope = e > 0 ? slope * step : 1 / range->phi;
    }
}

sh_real sh_scaled_basis_unit(const sh_range_parameters *range, int symmetric, int i, int j)
{
    const int e = sh_scaled_basis_power(symmetric, i);
    sh_real unit = e > 0 ? 1 / (sh_real)e : 1;
    int k;

    for (k = 0; k < e; ++k) {
        unit /= range->phi;
    }
    for (k = 0; k < j; ++k) {
        unit /= range->setPoint;
    }
    return sh_fmin(unit, SH_LARGEST_OUTPUT); /* single precision: phi^15 of a stiff joint */
}
