/* Misfit (point 7, detail 8): prediction errors of blocks that no column explains. The misfit increases the variances,
 * and decides how fast data are forgotten (detail 9).
 */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Number of blocks in the means that are the usual misfit and the usual squared error [1]. With this number, and with
 * SH_LARGEST_LEVEL, a change is found before its error becomes the usual error.
 */
#define SH_LEVEL_BLOCKS ((sh_real)400)
/* Number of blocks below which the misfit is not computed [1]: three blocks may have large errors by chance. */
#define SH_FEW_BLOCKS ((sh_real)4)
/* Number of blocks below which no data are forgotten [1]. */
#define SH_FIRST_BLOCKS ((sh_real)20)
/* Number of std deviations above which a sum of squared errors is not due to chance [1]. */
#define SH_CHANCE ((sh_real)3)
/* Number of blocks over which a misfit averages out [1]. Over more blocks, the misfit repeats with the motion. */
#define SH_REPEATS ((sh_real)5)
/* regression.memory divided by the time constant of the recent blocks [1]. */
#define SH_RECENT ((sh_real)10)
/* Ratio of the misfit and the usual misfit above which data are forgotten faster [1]. With the ratio 1, a second run of
 * an industrial robot, with other friction, makes the estimator forget the first run.
 */
#define SH_FAR_FROM_USUAL ((sh_real)3)
/* Factor by which data are forgotten faster if the recent blocks agree with each other [1]: the joint has changed. */
#define SH_FASTER ((sh_real)5)
/* Ratio of the misfit and the usual misfit above which the estimate is in doubt [1]. The usual misfit is known after
 * SH_USUAL_BLOCKS blocks, or 15 s. With the ratio 1.5, the estimate of logs without a change is in doubt for 4 % of the
 * time. With the ratio 2, twice as many changes are not noticed for more than 1 s.
 */
#define SH_SUDDEN_MISFIT ((sh_real)1.7)
#define SH_USUAL_BLOCKS ((sh_real)300)

void sh_misfit_start(sh_misfit *misfit, int size)
{
    sh_information_start(&misfit->recent, size, 1);
    misfit->square = misfit->variance_factor = misfit->usual = 1;
}

void sh_misfit_take(sh_misfit *misfit, const sh_real *mean, sh_real w, sh_real count, sh_real time)
{
    sh_real x[SH_MAX_ROW];

    (void)memcpy(x, mean, sizeof x);
    (void)sh_information_take(&misfit->recent, x, w);
    misfit->recent_count += count;
    misfit->duration += time;
}

sh_real sh_usual(sh_real mean, sh_real value, sh_real most, sh_real blocks)
{
    return sh_fmax(mean + (sh_fmin(value, most * mean) - mean) / blocks, 1);
}

void sh_misfit_learn(sh_misfit *misfit)
{
    misfit->judged = sh_fmin(misfit->judged + 1, SH_LEVEL_BLOCKS);
    misfit->usual =
        sh_usual(misfit->usual, sh_sqrt(misfit->square), SH_SUDDEN_MISFIT, misfit->judged);
}

void sh_misfit_begin_anew(sh_misfit *misfit)
{
    sh_information_start(&misfit->recent, misfit->recent.size, 1);
    misfit->recent_count = 0;
    misfit->usual *= SH_SUDDEN_MISFIT; /* what was learned of the motor may not fit as well */
}

/* ---- the variance factor, detail 8 ------------------------------------------------------- */

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

/* The prior is subtracted completely, although forgetting reduces the prior. This error is small, because beta' beta is
 * small compared with the squares of 20 blocks.
 */
void sh_misfit_judge_recent(sh_misfit *misfit, const sh_real *beta, int drifts)
{
    const sh_real N = misfit->recent_count;

    misfit->recent_square = 0;
    if (N >= SH_FIRST_BLOCKS && !drifts) {
        const sh_real squares = squares_of(&misfit->recent, beta, 1);

        misfit->recent_square = squares > sh_largest_by_chance(N) ? squares / N : 0;
    }
}

/* Returns 1 if N blocks are enough to forget data, and to subtract half the number of parameters in q. */
static int are_many_blocks(sh_real N, int parameters)
{
    return N >= SH_FIRST_BLOCKS && N > (sh_real)parameters;
}

/* q = squares / (N - p / 2), p parameters,
 *
 *     kappa^2 = max(q, q_recent, 1 + (q - t) max(1, N / 5))  if q > t, else max(1, q, q_recent) .
 *
 * A misfit is a function of the state and repeats with the motion, so the part q - t does not average out over N
 * blocks. With few blocks, q is the sum divided by N. With fewer than SH_FEW_BLOCKS blocks, nothing is computed.
 */
void sh_misfit_judge(sh_misfit *misfit, const sh_information *blocks, sh_real prior, sh_real N,
                     const sh_real *beta, int parameters, const sh_parameters *p)
{
    sh_real q, t;

    if (!(N >= SH_FEW_BLOCKS)) {
        return;
    }
    q = squares_of(blocks, beta, prior) /
        (are_many_blocks(N, parameters) ? N - (sh_real)parameters / 2 : N);
    t = sh_largest_by_chance(N) / N;
    misfit->square = sh_fmax(1, sh_fmax(q, misfit->recent_square));
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

/* ---- forgetting, detail 9 ---------------------------------------------------------------- */

/* Returns the misfit divided by the usual misfit [1]. */
static sh_real over_the_usual(const sh_misfit *misfit)
{
    return sh_sqrt(misfit->square) / misfit->usual;
}

int sh_misfit_is_sudden(const sh_misfit *misfit)
{
    return misfit->judged >= SH_USUAL_BLOCKS && over_the_usual(misfit) > SH_SUDDEN_MISFIT;
}

sh_real sh_misfit_forget_recent(sh_misfit *misfit, const sh_parameters *p)
{
    const sh_real moving = misfit->duration;

    misfit->duration = 0;
    if (p->regression.memory > 0) {
        const sh_real factor = sh_exp(-SH_RECENT * moving / p->regression.memory);

        sh_information_forget(&misfit->recent, factor, 1);
        misfit->recent_count *= factor;
    }
    return moving;
}

int sh_misfit_contradicts(const sh_misfit *misfit, sh_real N, int parameters)
{
    return misfit->variance_factor > SH_CONTRADICTION && are_many_blocks(N, parameters);
}

/* Data are forgotten faster while the misfit is more than three times the usual misfit, but not faster than the recent
 * blocks. If the recent blocks do not contradict each other, the joint has changed. In this case, data are forgotten at
 * least five times as fast.
 */
sh_real sh_misfit_forgetting(const sh_misfit *misfit, sh_real moving, const sh_parameters *p)
{
    const sh_real N = misfit->recent_count;
    const int has_changed = N > SH_FIRST_BLOCKS && misfit->recent.squares < sh_largest_by_chance(N);
    const sh_real sudden = sh_fmin(over_the_usual(misfit) / SH_FAR_FROM_USUAL, SH_RECENT);
    const sh_real faster = sh_fmax(sudden, has_changed ? SH_FASTER : 1);
    const sh_real memory = p->regression.memory / faster;

    return sh_exp(-moving / memory);
}
