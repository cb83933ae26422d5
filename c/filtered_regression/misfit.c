/* Misfit (section 8): prediction errors of blocks that no column explains. The misfit increases the variances,
 * and decides how fast data are forgotten (section 9).
 */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Number of blocks in the means that are the usual misfit and the usual squared error [1]. With this number, and with
 * SH_LARGEST_LEVEL, a change is found before its error becomes the usual error.
 */
#define SH_LEVEL_BLOCKS ((sh_real)400)
/* Number of std deviations above which a sum of squared errors is not due to chance [1]. */
#define SH_CHANCE ((sh_real)3)
/* Number of blocks over which a misfit averages out [1]. Over more blocks, the misfit repeats with the motion. */
#define SH_REPEATS ((sh_real)5)
/* Ratio of the misfit and the usual misfit above which data are forgotten faster, in proportion, and the largest factor
 * [1]. With the ratio 1, a second run of an industrial robot, with other friction, makes the estimator forget the first
 * run. With a tenth of regression.memory, the data are still a motion.
 */
#define SH_FAR_FROM_USUAL ((sh_real)3)
#define SH_FASTEST ((sh_real)10)
/* Ratio of the misfit and the usual misfit above which the estimate is in doubt [1]. The usual misfit is known after
 * SH_USUAL_BLOCKS blocks, or 15 s. With the ratio 1.5, the estimate of logs without a change is in doubt for 4 % of the
 * time. With the ratio 2, twice as many changes are not noticed for more than 1 s.
 */
#define SH_SUDDEN_MISFIT ((sh_real)1.7)
#define SH_USUAL_BLOCKS ((sh_real)300)

void sh_misfit_start(sh_misfit *misfit)
{
    (void)memset(misfit, 0, sizeof *misfit);
    misfit->square = misfit->variance_factor = misfit->usual = 1;
}

sh_real sh_usual(sh_real mean, sh_real value, sh_real most, sh_real blocks)
{
    return sh_fmax(mean + (sh_fmin(value, most * mean) - mean) / blocks, 1);
}

void sh_misfit_learn(sh_misfit *misfit, sh_real duration)
{
    misfit->duration += duration;
    misfit->judged = sh_fmin(misfit->judged + 1, SH_LEVEL_BLOCKS);
    misfit->usual =
        sh_usual(misfit->usual, sh_sqrt(misfit->square), SH_SUDDEN_MISFIT, misfit->judged);
}

void sh_misfit_begin_anew(sh_misfit *misfit)
{
    misfit->usual *= SH_SUDDEN_MISFIT; /* what was learned of the motor may not fit as well */
}

/* ---- the variance factor, section 8 ------------------------------------------------------ */

/* N t, t = 1 + 3 sqrt(2 / N) */
sh_real sh_largest_by_chance(sh_real N)
{
    return N + SH_CHANCE * sh_sqrt(2 * N);
}

/* Returns the sum of the squared errors of the blocks, divided by their variances, with coefficients beta. The matrix
 * of the blocks also contains the share `prior` of the prior, 0..1, which is subtracted.
 */
static sh_real squares_of(const sh_information *blocks, const sh_real *beta, sh_real prior)
{
    return sh_information_squares(blocks, beta) -
           prior * sh_sum_of_products(beta, beta, blocks->size);
}

/* Returns 1 if N blocks are enough to forget data, and to subtract half the number of parameters in q. */
static int are_many_blocks(sh_real N, int parameters)
{
    return N > (sh_real)parameters;
}

/* (F19), (F20): q = squares / (N - p / 2), p parameters,
 *
 *     kappa^2 = max(q, 1 + (q - t) max(1, N / 5))  if q > t, else max(1, q) .
 *
 * A misfit is a function of the state and repeats with the motion, so the part q - t does not average out over N
 * blocks. With few blocks, q is the sum divided by N.
 */
void sh_misfit_judge(sh_misfit *misfit, const sh_information *blocks, sh_real prior, sh_real N,
                     const sh_real *beta, int parameters, const sh_parameters *p)
{
    sh_real q, t;

    if (!(N > 0)) {
        return;
    }
    q = squares_of(blocks, beta, prior) /
        (are_many_blocks(N, parameters) ? N - (sh_real)parameters / 2 : N);
    t = sh_largest_by_chance(N) / N;
    misfit->square = sh_fmax(1, q);
    misfit->variance_factor = 1;
    if (!(p->regression.memory > 0)) { /* switched off */
        return;
    }
    misfit->variance_factor = misfit->square;
    if (q > t) {
        misfit->variance_factor =
            sh_fmax(misfit->variance_factor, 1 + (q - t) * sh_fmax(1, N / SH_REPEATS));
    }
}

/* ---- forgetting, section 9 --------------------------------------------------------------- */

/* Returns the misfit divided by the usual misfit [1]. */
static sh_real over_the_usual(const sh_misfit *misfit)
{
    return sh_sqrt(misfit->square) / misfit->usual;
}

int sh_misfit_is_sudden(const sh_misfit *misfit)
{
    return misfit->judged >= SH_USUAL_BLOCKS && over_the_usual(misfit) > SH_SUDDEN_MISFIT;
}

/* (F21). The time of forgetting is the duration of the blocks, so no data are forgotten at rest. */
sh_real sh_misfit_forgetting(sh_misfit *misfit, sh_real N, int parameters, const sh_parameters *p)
{
    const sh_real moving = misfit->duration;
    const sh_real faster = sh_fmin(over_the_usual(misfit) / SH_FAR_FROM_USUAL, SH_FASTEST);

    misfit->duration = 0;
    if (!(p->regression.memory > 0 && misfit->variance_factor > SH_CONTRADICTION &&
          are_many_blocks(N, parameters))) {
        return 1;
    }
    return sh_exp(-moving * sh_fmax(1, faster) / p->regression.memory);
}
