/* Runs the estimator over a log, on the host or on a microcontroller.
 *
 * replay LOG OUT CONFIGURATION
 *
 * LOG is a file with the five measurements of each tick as doubles in the byte order of the machine. The program writes
 * the sh_estimate of each tick to the file OUT. CONFIGURATION is a letter from the function configure().
 */
#include <stdio.h>

#include "sigmahat.h"

/* Sets a configuration; all configurations together use each variant of each block. Returns 0 for an unknown letter. */
static int configure(sh_parameters *p, char configuration)
{
    sh_parameters_default(p);
    p->method = configuration < 'g' ? SH_METHOD_PAPER2011 : SH_METHOD_FILTERED_REGRESSION;
    switch (configuration) {
    case 'a': /* Table I */
    case 'g':
        break;
    case 'b':
        p->modality = SH_MODALITY_SENSOR;
        break;
    case 'c':
        p->modality = SH_MODALITY_MODEL;
        break;
    case 'd':
        p->deformation = SH_DEFORMATION_FILTERED;
        p->filter.kind = SH_FILTER_KALMAN;
        break;
    case 'e':
        p->filter.kind = SH_FILTER_FINITE_DIFFERENCE;
        p->rls.kind = SH_RLS_STANDARD;
        p->rls.P_0 = 1; /* the ridge c P_0 is the same as in Table I */
        break;
    case 'f':
        p->filter.weighting = SH_WEIGHTING_AS_PRINTED;
        p->rls.kind = SH_RLS_CONSTANT_FACTOR;
        break;
    case 'h':
        p->modality = SH_MODALITY_SENSOR;
        p->rls.symmetric = 0;
        break;
    case 'i':
        p->rls.n = 2;
        p->rls.eta_0[0][1] = 3;
        p->prior.nominal = (sh_real)0.3;
        p->prior.B = (sh_real)0.2;
        p->prior.tau_coulomb = (sh_real)0.02;
        p->regression.drift = (sh_real)1e-3;
        break;
    default:
        return 0;
    }
    return 1;
}

int main(int count, char **arguments)
{
    static sh_parameters parameters;
    static sh_estimator estimator;
    static sh_estimate e;
    sh_violation violation;
    double log[5];
    FILE *in, *out;

    if (count != 4 || !configure(&parameters, arguments[3][0]) ||
        sh_parameters_check(&parameters, &violation)) {
        return 1;
    }
    in = fopen(arguments[1], "rb");
    out = fopen(arguments[2], "wb");
    if (in == NULL || out == NULL) {
        return 2;
    }
    sh_estimator_start(&estimator, &parameters, &e);
    while (fread(log, sizeof log, 1, in) == 1) {
        const sh_measurement z = {(sh_real)log[0], (sh_real)log[1], (sh_real)log[2],
                                  (sh_real)log[3], (sh_real)log[4]};

        sh_estimator_tick(&estimator, &parameters, &z, &e);
        if (fwrite(&e, sizeof e, 1, out) != 1) {
            return 3;
        }
    }
    return fclose(out) == 0 ? 0 : 3;
}
