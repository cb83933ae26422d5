/* The bank of hypotheses (section 12). Each hypothesis predicts each block, and the errors show which one is
 * true:
 *
 *     constant  the joint is as before: the prior and all blocks
 *     spring    the spring has changed since t: the first columns, which belong to the spring, start again at t from
 *               what is left of their prior. The rows behind these columns keep the information of earlier data about
 *               motor and friction. So does the bias, but as far as it is the torque of the spring at the zero of the
 *               encoders, it changes with the stiffness: its variance grows by its square.
 *     friction  the prior and all blocks, while friction drifts slowly. From the evidence SH_MAY_HAVE_CHANGED against
 *               the present hypothesis on, friction may also have changed by about the std deviations of its priors.
 *
 * After a test without a change, `friction` becomes equal to `constant` again, unless it is clearly better. The bank
 * only returns what it found: the tick adopts the hypothesis.
 */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Largest value of one block in the mean that is the usual squared error, in usual squared errors [1]; see
 * SH_LEVEL_BLOCKS.
 */
#define SH_LARGEST_LEVEL ((sh_real)9)
/* Largest effective number of blocks [1]: 100 s, so that a misfit that begins after hours is noticed soon. */
#define SH_MOST_BLOCKS ((sh_real)2000)
/* Residual with drifting friction divided by the residual with constant friction [1]. Friction counts as drifting below
 * the first ratio, and as constant above the second ratio.
 */
#define SH_DRIFT_BEGINS ((sh_real)0.8)
#define SH_DRIFT_ENDS ((sh_real)0.95)
/* Largest evidence of one block, which is divided by the usual misfit, and the lower limit of this quotient [1]. One
 * block alone, which may be an impact, is then no change. With 25 for both numbers, a sixth fewer changes are found.
 * With 50 for both numbers, 300 simulated runs had 17 false changes instead of 10.
 */
#define SH_LARGEST_EVIDENCE ((sh_real)50)
#define SH_LEAST_LIMIT_OF_EVIDENCE ((sh_real)25)
/* Difference of the squared errors, in usual squared errors, above which one hypothesis is clearly better [1]: another
 * spring, or other friction. After SH_BLOCKS_TO_DECIDE blocks, any difference decides. With the difference 10, or with 8
 * blocks, twice as many of 160 simulated changes of friction are reported as changes of the spring. The difference 25
 * delays the estimate of a changed spring by 0.1 s.
 */
#define SH_CLEARLY_BETTER ((sh_real)25)
#define SH_BLOCKS_TO_DECIDE ((sh_real)20)
/* Squared error, in usual squared errors, above which a block contradicts the changed spring [1]: 3.5 std deviations.
 */
#define SH_CONTRADICTS ((sh_real)12.5)
/* Number of blocks after which the hypothesis of a changed spring starts again [1]: 4 s. */
#define SH_LONGEST_TEST ((sh_real)80)
/* Least number of blocks for the detection of a change [1]. */
#define SH_SHORTEST_PAST ((sh_real)40)

void sh_bank_start(sh_bank *bank, int size)
{
    sh_information_start(&bank->constant, size, 1);
    sh_information_start(&bank->friction, size, 1);
    sh_information_start(&bank->spring, size, 1);
    bank->prior = bank->level = 1;
    bank->error = bank->friction_error = bank->spring_error = 0;
    bank->count = bank->past = bank->evidence = bank->preference = bank->friction_blocks = 0;
    bank->following = bank->friction_drifts = bank->widened = 0;
    bank->drift.w = 0;
    bank->blocks = SH_LONGEST_TEST; /* it begins with the first block that can show a change */
}

const sh_information *sh_bank_present(const sh_bank *bank)
{
    return bank->friction_drifts ? &bank->friction : &bank->constant;
}

/* ---- a block ----------------------------------------------------------------------------- */

/* Starts the hypothesis `spring` now: t is the end of the last block without evidence. A block before t must not count
 * for the changed spring, because that block contradicts the blocks after t.
 */
static void begin_spring(sh_bank *bank, const sh_columns *columns, const sh_real *beta)
{
    const int next = columns->spring;

    bank->spring = *sh_bank_present(bank);
    sh_information_restart(&bank->spring, next, bank->prior);
    if (next < columns->size && columns->column[next].kind == SH_COLUMN_BIAS) {
        sh_information_widen(&bank->spring, next, sh_square(beta[next]));
    }
    bank->evidence = bank->blocks = 0;
}

/* Takes or only predicts the mean row of a block. Returns the squared error / its variance [1]. */
static sh_real take_block(sh_information *a, const sh_block_mean *mean, int only_predicts)
{
    sh_real x[SH_MAX_ROW], error;

    (void)memcpy(x, mean->x, sizeof x);
    error =
        only_predicts ? sh_information_predict(a, x, mean->w) : sh_information_take(a, x, mean->w);
    return sh_limited(error * sh_square(x[a->size + SH_RIGHT_Y]), SH_LARGE);
}

/* The hypothesis `spring` does not take its first block. If the first block is evidence, the spring changes in this
 * block; otherwise, the hypothesis begins anew after the block. If a later block contradicts the hypothesis, and one
 * block alone may be all the evidence, the spring has changed after t. In this case, t becomes the begin of this block,
 * which `constant` has not taken yet. The hypothesis leaves this block out, because the spring changes in this block.
 */
void sh_bank_take_for_spring(sh_bank *bank, const sh_columns *columns, const sh_real *beta,
                             const sh_block_mean *mean)
{
    const sh_real error = take_block(&bank->spring, mean, !(bank->blocks > 0));

    bank->spring_error = error;
    if (error > SH_CONTRADICTS * bank->level && !(bank->evidence > SH_LARGEST_EVIDENCE)) {
        begin_spring(bank, columns, beta);
        bank->spring_error = 0;
    }
}

void sh_bank_take_as_before(sh_bank *bank, const sh_block_mean *mean)
{
    bank->error = take_block(&bank->constant, mean, 0);
}

void sh_bank_take_for_friction(sh_bank *bank, const sh_block_mean *mean)
{
    bank->friction_error = take_block(&bank->friction, mean, 0);
    bank->error = bank->friction_drifts ? bank->friction_error : bank->error;
}

/* ---- all blocks -------------------------------------------------------------------------- */

void sh_bank_count(sh_bank *bank, sh_real count)
{
    bank->count += count;
    bank->past = sh_fmin(bank->past + count, SH_SHORTEST_PAST);
    if (bank->count > SH_MOST_BLOCKS) {
        sh_bank_forget(bank, SH_MOST_BLOCKS / bank->count);
    }
}

void sh_bank_forget(sh_bank *bank, sh_real factor)
{
    sh_information_forget(&bank->constant, factor, SH_LEAST_INFORMATION);
    sh_information_forget(&bank->friction, factor, SH_LEAST_INFORMATION);
    bank->prior *= factor;
    bank->count *= factor;
}

void sh_bank_drift(sh_bank *bank, const sh_real *v, sh_real variance)
{
    (void)sh_information_drift(&bank->constant, v, variance);
    (void)sh_information_drift(&bank->friction, v, variance);
}

/* ---- friction, section 12 ---------------------------------------------------------------- */

void sh_bank_prepare_drift(sh_bank *bank, int column, sh_real variance)
{
    sh_sample_prepare(&bank->drift, &bank->friction, column, variance);
}

void sh_bank_take_drift(sh_bank *bank)
{
    sh_sample_take(&bank->drift, &bank->friction);
}

void sh_bank_judge_drift(sh_bank *bank)
{
    const sh_real N = bank->count, parameters = (sh_real)bank->constant.size;
    const sh_real constant = bank->constant.squares, drifting = bank->friction.squares;

    if (!(N > 2 * parameters) || bank->friction_blocks > 0) {
        return;
    }
    if (drifting < SH_DRIFT_BEGINS * constant &&
        constant > (N - parameters) * sh_largest_by_chance(N) / N) {
        bank->friction_drifts = 1;
    } else if (drifting > SH_DRIFT_ENDS * constant) {
        bank->friction_drifts = 0;
    }
}

/* Starts the test of other friction now, if the regression has columns of friction. If friction drifts, the hypothesis
 * that it drifts is adopted first, so that the test is between the present friction and another one. Without a test
 * while friction drifts, 39 and not 2 of 120 simulated changes of friction were taken for another spring. A prepared
 * sample of the drift is dropped, because the widening of columns uses the same sample.
 */
static void begin_friction(sh_bank *bank, const sh_columns *columns, const sh_parameters *p)
{
    if (columns->friction < columns->inertia && !sh_is_measured(p)) {
        if (bank->friction_drifts) {
            bank->constant = bank->friction;
            bank->friction_drifts = 0;
        }
        bank->friction_blocks = 1;
        bank->preference = 0;
        bank->widened = columns->friction;
        bank->drift.w = 0;
    }
}

int sh_bank_is_widening(const sh_bank *bank, const sh_columns *columns)
{
    return bank->friction_blocks > 0 && bank->widened < columns->inertia;
}

static void widen_next_column(sh_bank *bank)
{
    if (bank->widened < SH_MAX_COLUMNS) {
        bank->widened += 1;
    }
}

/* Adds process noise of variance 1 to one column in each row: step 0 prepares a sample, and step 1 takes the sample. If
 * nothing is known about the column, there is no sample.
 */
void sh_bank_widen_friction(sh_bank *bank, int step)
{
    if (step == 0) {
        sh_bank_prepare_drift(bank, bank->widened, 1);
        if (!(bank->drift.w < 0)) {
            widen_next_column(bank);
        }
    } else if (step == 1 && bank->drift.w < 0) {
        sh_bank_take_drift(bank);
        widen_next_column(bank);
    }
}

/* Ends the test of other friction without a change. If other friction is clearly better, friction may drift, and the
 * matrix stays.
 */
static void end_friction(sh_bank *bank)
{
    if (bank->friction_blocks > 0 && !(bank->preference < -SH_CLEARLY_BETTER)) {
        bank->friction = bank->constant;
        bank->drift.w = 0; /* a prepared sample belongs to the earlier matrix */
    }
    bank->friction_blocks = 0;
}

/* ---- what has changed, section 12 -------------------------------------------------------- */

/* Decides for another spring if it is clearly better than other friction, or better after SH_BLOCKS_TO_DECIDE blocks.
 * `friction_blocks` begins at 1, so this is the 19th block of the test. Other friction is found only then.
 */
static sh_finding decide(const sh_bank *bank)
{
    if (!(bank->friction_blocks > 0) || bank->preference > SH_CLEARLY_BETTER ||
        (bank->friction_blocks >= SH_BLOCKS_TO_DECIDE && bank->preference >= 0)) {
        return SH_FOUND_SPRING;
    }
    return bank->friction_blocks >= SH_BLOCKS_TO_DECIDE ? SH_FOUND_FRICTION : SH_FOUND_NOTHING;
}

/* (F27): E = max(0, E + min(z_0 / l, c) - 2 min(z_1 / l, 12.5) - 2), c = max(50 / m, 25), where z are squared errors
 * divided by their variances, l >= 1 is the usual value of z, and m >= 1 is the usual misfit. A permanent misfit makes
 * all hypotheses wrong, so the usual misfit reduces the limit c.
 */
static void weigh_evidence(sh_bank *bank, sh_real level, sh_real usual_misfit)
{
    const sh_real most = sh_fmax(SH_LARGEST_EVIDENCE / usual_misfit, SH_LEAST_LIMIT_OF_EVIDENCE);

    /* (F28). The preference does not use the first block of a hypothesis. */
    if (bank->friction_blocks > 1 && bank->blocks > 0) {
        bank->preference += sh_fmin(bank->friction_error / level, SH_LARGEST_EVIDENCE) -
                            sh_fmin(bank->spring_error / level, SH_LARGEST_EVIDENCE);
    }
    bank->friction_blocks += bank->friction_blocks > 0 ? 1 : 0;
    bank->blocks += 1;
    bank->evidence = sh_fmax(bank->evidence + sh_fmin(bank->error / level, most) -
                                 2 * sh_fmin(bank->spring_error / level, SH_CONTRADICTS) - 2,
                             0);
}

sh_finding sh_bank_judge(sh_bank *bank, const sh_columns *columns, const sh_real *beta,
                         sh_real judged, sh_real usual_misfit, const sh_parameters *p)
{
    const sh_real level = bank->level;

    if (!(p->regression.memory > 0)) { /* switched off */
        end_friction(bank);
        bank->evidence = 0;
        return SH_FOUND_NOTHING;
    }
    bank->level = sh_usual(level, bank->error, SH_LARGEST_LEVEL, judged);
    if (bank->past < SH_SHORTEST_PAST) {
        return SH_FOUND_NOTHING;
    }
    weigh_evidence(bank, level, usual_misfit);
    if (!(bank->evidence > 0) || bank->blocks >= SH_LONGEST_TEST) {
        end_friction(bank);
        begin_spring(bank, columns, beta);
    } else if (bank->following == 0 && bank->evidence > SH_MAY_HAVE_CHANGED) {
        if (!(bank->friction_blocks > 0)) {
            begin_friction(bank, columns, p);
        }
        if (bank->evidence > SH_HAS_CHANGED * sh_sqrt(level)) {
            return decide(bank);
        }
    }
    return SH_FOUND_NOTHING;
}

void sh_bank_adopt(sh_bank *bank, const sh_columns *columns, const sh_real *beta, sh_finding found)
{
    if (found == SH_FOUND_SPRING) {
        bank->friction = bank->spring;
    }
    bank->constant = bank->friction;
    bank->following = 1;
    bank->friction_blocks = 0;
    begin_spring(bank, columns, beta);
}

void sh_bank_followed(sh_bank *bank)
{
    bank->following = 0;
}
