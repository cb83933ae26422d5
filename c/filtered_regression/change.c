/* A stiffness that changes (detail 15): three hypotheses predict each block, and the estimate follows the best one.
 *
 *     0  the joint is as before: the prior and all blocks
 *     1  the spring has changed since t: the first columns, which belong to the spring, start again at t from their
 *        prior. The rows behind these columns keep the information of earlier data about motor and friction.
 *     2  friction has changed by about the std deviations of its priors: the prior and all blocks
 *
 * Hypothesis 2 begins when there is evidence against hypothesis 0. Hypothesis 2 uses the matrix `drifting` of the
 * blocks. If nothing has changed, this matrix becomes equal to the matrix `constant` of hypothesis 0 again.
 */
#include "constants.h"
#include "regression.h"

void sh_change_start(sh_regression_state *state)
{
    sh_change *change = &state->change;

    sh_information_start(&change->changed, state->columns.size, 1);
    change->level = change->usual_misfit = 1;
    change->blocks = SH_LONGEST_TEST; /* it begins with the first block that can show a change */
    state->history.change_age = -1;
}

/* Starts hypothesis 1 now: t is the end of the last block without evidence. A block before t must not count for the
 * changed spring, because that block contradicts the blocks after t.
 */
static void begin(sh_regression_state *state)
{
    const sh_blocks *blocks = &state->blocks;
    sh_change *change = &state->change;

    change->changed = state->friction_drifts ? blocks->drifting : blocks->constant;
    sh_information_restart(&change->changed, state->columns.spring, blocks->prior);
    change->evidence = change->blocks = 0;
}

/* Starts hypothesis 2 now, if the regression has columns of friction and assumes constant friction. A prepared sample
 * of the drift of friction is dropped, because the sample was computed from the earlier blocks.
 */
static void begin_friction(sh_regression_state *state, const sh_parameters *p)
{
    sh_change *change = &state->change;

    if (state->columns.friction < state->columns.inertia && !state->friction_drifts &&
        !sh_is_measured(p)) {
        change->friction_blocks = 1;
        change->preference = 0;
        change->widened = state->columns.friction;
        state->refit.w = 0;
    }
}

/* Adds process noise of variance 1 to one column in each row: step 0 prepares a sample, and step 1 takes the sample. */
int sh_change_widens_friction(sh_regression_state *state, int step)
{
    sh_information *const blocks = &state->blocks.drifting;
    sh_change *change = &state->change;
    sh_refit *refit = &state->refit;

    if (!(change->friction_blocks > 0) || change->widened >= state->columns.inertia) {
        return 0;
    }
    if (step == 0) {
        sh_drift_step(refit, blocks, change->widened, 1, step);
        change->widened += refit->w < 0 ? 0 : 1; /* nothing is known about it */
    } else if (step == 1 && refit->w < 0) {
        sh_drift_step(refit, blocks, change->widened, 1, step);
        change->widened += 1;
    }
    return 1;
}

/* Ends hypothesis 2 without a change. If other friction is clearly better, friction may drift: `drifting` stays. */
static void end_friction(sh_regression_state *state)
{
    sh_change *change = &state->change;

    if (change->friction_blocks > 0 && !(change->preference < -SH_CLEARLY_BETTER)) {
        state->blocks.drifting = state->blocks.constant;
    }
    change->friction_blocks = 0;
}

/* If a block contradicts hypothesis 1, and one block alone may be all the evidence, the spring has changed after t. In
 * this case, t becomes the begin of this block, which hypothesis 0 has not taken yet. Hypothesis 1 leaves this block
 * out, because the spring changes in this block.
 */
int sh_change_begins_anew(sh_regression_state *state, sh_real error)
{
    if (!(error > SH_CONTRADICTS * state->change.level) ||
        state->change.evidence > SH_LARGEST_EVIDENCE) {
        return 0;
    }
    begin(state);
    return 1;
}

/* Adopts the hypothesis in blocks.drifting: its matrix replaces the blocks and the data of all samples. The data of all
 * samples must be replaced, because their samples after t contradict their information about the motor. The next
 * posterior contains the prior twice, because the blocks also contain the prior, but the blocks soon outweigh the
 * prior. The sums that describe the noise of single samples begin at 0, because blocks hardly contain this noise.
 */
static void adopt(sh_regression_state *state, const sh_parameters *p)
{
    sh_blocks *blocks = &state->blocks;
    sh_change *change = &state->change;

    blocks->constant = blocks->drifting;
    sh_information_start(&blocks->recent, state->columns.size, 1);
    blocks->recent_count = 0;
    state->data = blocks->drifting;
    state->surplus = state->spread = state->weights = 0;
    state->noise.information = state->noise.gain = 0;
    state->refit.trial = 0;
    sh_refit_begin(state, p);
    change->following = 1;
    change->usual_misfit *=
        SH_SUDDEN_MISFIT; /* what was learned of the motor may not fit as well */
    change->friction_blocks = 0;
    begin(state);
}

/* Adopts hypothesis 1 if hypothesis 1 is clearly better than hypothesis 2, or better after SH_BLOCKS_TO_DECIDE blocks.
 */
static void decide(sh_regression_state *state, const sh_parameters *p)
{
    sh_change *change = &state->change;

    if (!(change->friction_blocks > 0) || change->preference > SH_CLEARLY_BETTER ||
        (change->friction_blocks >= SH_BLOCKS_TO_DECIDE && change->preference >= 0)) {
        state->blocks.drifting = change->changed;
        state->history.change_age = 0;
        adopt(state, p);
    } else if (change->friction_blocks >= SH_BLOCKS_TO_DECIDE) {
        adopt(state, p);
    }
}

/* Returns the mean, at least 1, after one more value. The value counts as at most `most` times the mean. */
static sh_real usual(sh_real mean, sh_real value, sh_real most, sh_real blocks)
{
    return sh_fmax(mean + (sh_fmin(value, most * mean) - mean) / blocks, 1);
}

/* g = max(0, g + min(z_0 / l, c) - 2 min(z_1 / l, 12.5) - 2), c = max(50 / m, 25), where z are squared errors divided
 * by their variances, l >= 1 is the usual value of z, and m >= 1 is the usual misfit. A permanent misfit makes all
 * hypotheses wrong, so the usual misfit reduces the limit c.
 */
void sh_change_judge(sh_regression_state *state, const sh_parameters *p, sh_real before,
                     sh_real spring, sh_real friction)
{
    sh_change *change = &state->change;
    const sh_real level = change->level;
    sh_real most;

    if (!(p->regression.memory > 0)) { /* switched off */
        end_friction(state);
        change->evidence = 0;
        return;
    }
    change->judged = sh_fmin(change->judged + 1, SH_LEVEL_BLOCKS);
    change->level = usual(level, before, SH_LARGEST_LEVEL, change->judged);
    change->usual_misfit =
        usual(change->usual_misfit, sh_sqrt(state->misfit), SH_SUDDEN_MISFIT, change->judged);
    if (state->blocks.count < SH_SHORTEST_PAST) {
        return;
    }
    /* The preference does not use the first block of a hypothesis. */
    if (change->friction_blocks > 1 && change->blocks > 0) {
        change->preference += sh_fmin(friction / level, SH_LARGEST_EVIDENCE) -
                              sh_fmin(spring / level, SH_LARGEST_EVIDENCE);
    }
    change->friction_blocks += change->friction_blocks > 0 ? 1 : 0;
    most = sh_fmax(SH_LARGEST_EVIDENCE / change->usual_misfit, SH_LEAST_LIMIT_OF_EVIDENCE);
    change->blocks += 1;
    change->evidence = sh_fmax(change->evidence + sh_fmin(before / level, most) -
                                   2 * sh_fmin(spring / level, SH_CONTRADICTS) - 2,
                               0);
    if (!(change->evidence > 0) || change->blocks >= SH_LONGEST_TEST) {
        end_friction(state);
        begin(state);
    } else if (change->following == 0 && change->evidence > SH_MAY_HAVE_CHANGED) {
        if (!(change->friction_blocks > 0)) {
            begin_friction(state, p);
        }
        if (change->evidence > SH_HAS_CHANGED * sh_sqrt(level)) {
            decide(state, p);
        }
    }
}

sh_real sh_change_misfit(const sh_regression_state *state)
{
    return sh_sqrt(state->misfit) / state->change.usual_misfit;
}

int sh_change_is_likely(const sh_regression_state *state)
{
    const sh_change *change = &state->change;
    const int is_sudden =
        change->judged >= SH_USUAL_BLOCKS && sh_change_misfit(state) > SH_SUDDEN_MISFIT;

    return change->following || change->evidence > SH_MAY_HAVE_CHANGED || is_sudden;
}
