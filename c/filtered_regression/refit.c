/* Refits apply a new misfit, or a new choice of columns, to past samples in bounded time (section 7). A refit computes a
 * new posterior beside the present posterior: each row of the triangular matrix of the data, with its weight, is a
 * sample for the new posterior. A step of the refit takes one row of this matrix, beginning with the last, or two rows
 * while the rows are short. A new row of the regression updates the matrix from the first row to the last. The new
 * posterior also takes the new row, after the unread rows of the matrix have reduced the row. From some
 * blocks on, every second refit tries a group of columns, if there is one, and the estimate of a trial is not used.
 */
#include <string.h>

#include "real_math.h"
#include "regression.h"

/* Pause between two refits, divided by the duration of the counted blocks [1]. In 1 % more time, the estimate can
 * hardly change. The number is no simple ratio of blocks and rows, so that rounding errors have no effect.
 */
#define SH_REFIT_PAUSE ((sh_real)0.0101)
/* Number of blocks from which refits try groups of columns [1]. With 15 blocks, the estimates of 360 random joints were
 * confident and over 20 % wrong for 0.42 % of the time. With 10 or 20, the share was 0.54 or 0.47 %.
 */
#define SH_FIRST_TRIAL ((sh_real)15)
/* Pause between two refits before groups are tried [s]. A refit removes noise (section 6) and computes the misfit. */
#define SH_FIRST_PAUSE ((sh_real)0.2)
/* A group of columns is used if it increases the log evidence by the first number plus the second number for each block
 * [1]. Such a group reduces the variance of the error by a tenth. The limit is necessary, because rounding of a
 * periodic motion is a small evidence for any column.
 */
#define SH_FIRST_GAIN ((sh_real)3)
#define SH_GAIN_PER_BLOCK ((sh_real)0.05)
/* Increase of the log evidence for each block from which possible knees are used [1]. With coarse encoders, a knee that
 * changes sigma by a third is a small evidence. For springs with knees, the interval contained the stiffness at 84 % of
 * the confident instants with 0.05, and at 89 % with 0.01. The results for springs without knees are equal.
 */
#define SH_KNEE_GAIN_PER_BLOCK ((sh_real)0.01)

/* Returns the part 0..3 of the posterior that contains column i; -1 if the column is not used. Part 1 contains
 * the columns of the spring, so that their variances need few rows of U. Part 2 contains columns of the motor, whose
 * information is changed or whose variance is used. Part 3 contains the group of columns that is tried.
 */
static int place_of(const sh_refit *refit, const sh_columns *columns, const sh_signals *signals,
                    const sh_parameters *p, int i)
{
    const sh_column *column = &columns->column[i];
    const int group = sh_column_kinds[column->kind].group;

    if (group != 0 && (!sh_column_is_distinct(columns, signals, p, i) ||
                       (group != refit->trial && !refit->used[group]))) {
        return -1;
    }
    return group != 0 && group == refit->trial ? 3
           : column->kind >= SH_COLUMN_DRIVE   ? 2
           : i < columns->spring               ? 1
                                               : 0;
}

/* Chooses columns [size: SH_MAX_COLUMNS] for the refit. Returns their number. */
static int choose_columns(const sh_refit *refit, const sh_columns *columns,
                          const sh_signals *signals, const sh_parameters *p, short *chosen)
{
    int places[SH_MAX_COLUMNS] = {0}, size = 0, place, i;

    /*@ loop unroll SH_MAX_COLUMNS; */
    for (i = 0; i < columns->size; ++i) {
        places[i] = place_of(refit, columns, signals, p, i);
    }
    /*@ loop unroll 4; */
    for (place = 0; place < 4; ++place) {
        /*@ loop unroll SH_MAX_COLUMNS; */
        for (i = 0; i < columns->size; ++i) {
            if (size < columns->size && place == places[i]) {
                chosen[size++] = (short)i;
            }
        }
    }
    return size;
}

void sh_refit_start(sh_refit *refit)
{
    refit->trial = refit->last_trial = 0;
    (void)memset(refit->used, 0, sizeof refit->used);
    refit->pause = 0;
}

void sh_refit_begin(sh_refit *refit, const sh_columns *columns, const sh_signals *signals,
                    const sh_samples *samples, sh_real variance_factor, const sh_parameters *p)
{
    const sh_real weight = 1 / variance_factor;
    const int size = choose_columns(refit, columns, signals, p, refit->posterior.column);

    sh_information_start(&refit->posterior.information, size, 1);
    refit->posterior.weight = weight;
    refit->posterior.removed = 0;
    refit->posterior.surplus = samples->surplus * weight;
    refit->posterior.spread = samples->spread * weight * weight;
    refit->unread = samples->data.size;
    refit->is_open = 1;
}

/* The next group that can be tried, 0 if there is none. */
static int next_trial(sh_refit *refit, const sh_columns *columns, const sh_signals *signals,
                      const sh_parameters *p)
{
    int tries, i;

    for (tries = 1; tries < SH_GROUPS; ++tries) {
        refit->last_trial = refit->last_trial % (SH_GROUPS - 1) + 1;
        for (i = 0; i < columns->size; ++i) {
            if (sh_column_kinds[columns->column[i].kind].group == refit->last_trial &&
                sh_column_is_distinct(columns, signals, p, i)) {
                return refit->last_trial;
            }
        }
    }
    return 0;
}

/* (F23): ln p(y | with the group) - ln p(y | without) = sum over its columns of (D z^2 - ln D) / 2 */
static sh_real gain_of_evidence(const sh_refit *refit, const sh_columns *columns)
{
    const sh_posterior *posterior = &refit->posterior;
    const sh_information *a = &posterior->information;
    sh_real row[SH_MAX_ROW] = {0}, gain = 0;
    int i;

    for (i = 0; i < a->size; ++i) {
        const sh_column *column = &columns->column[posterior->column[i]];

        if (sh_column_kinds[column->kind].group == refit->trial) {
            const sh_real D = sh_information_sample(a, i, row), z = row[a->size + SH_RIGHT_Y];

            gain += (D * z * z - sh_log(D)) / 2;
        }
    }
    return gain;
}

/* A group is used above a log evidence of 3 + 0.05 N, and no longer below 0.025 N; knees 3 + 0.01 N, and 0.005 N. */
void sh_refit_decide_about_group(sh_refit *refit, const sh_columns *columns, sh_real N)
{
    const int are_knees = refit->trial == sh_column_kinds[SH_COLUMN_POSSIBLE_KNEE].group;
    const sh_real gain = gain_of_evidence(refit, columns),
                  per_blocks = (are_knees ? SH_KNEE_GAIN_PER_BLOCK : SH_GAIN_PER_BLOCK) * N;

    if (gain > SH_FIRST_GAIN + per_blocks) {
        refit->used[refit->trial] = 1;
    }
    if (gain < per_blocks / 2) {
        refit->used[refit->trial] = 0;
    }
}

/* Noise is removed from the column of the inertia (F13) before the column of the motor torque (F15). In the
 * other order, the rounding error in the column of the inertia would bias the column of the motor torque.
 */
void sh_refit_remove_noise(sh_refit *refit, const sh_columns *columns, const sh_column_noise *noise,
                           const sh_parameters *p)
{
    sh_posterior *posterior = &refit->posterior;
    int i;

    if (p->prior.B > 0) {
        sh_posterior_remove(posterior, p->prior.B);
    }
    for (i = 0; i < posterior->information.size; ++i) {
        if (columns->column[posterior->column[i]].kind == SH_COLUMN_DRIVE) {
            sh_posterior_remove_noise(posterior, p->prior.B, i, noise);
        }
    }
}

static void take_unread_row(sh_refit *refit, const sh_information *data)
{
    sh_real x[SH_MAX_ROW] = {0}, w;

    refit->unread -= 1;
    w = sh_information_sample(data, refit->unread, x);
    (void)sh_posterior_take(&refit->posterior, x, data->size, w);
}

int sh_refit_read(sh_refit *refit, const sh_information *data)
{
    if (!(refit->unread > 0)) {
        return 0;
    }
    take_unread_row(refit, data);
    if (refit->unread > data->size / 2) { /* the last rows are short */
        take_unread_row(refit, data);
    }
    return 1;
}

void sh_refit_wait(sh_refit *refit, sh_real time)
{
    refit->pause += time;
}

void sh_refit_take_rest(sh_refit *refit, int size)
{
    if (refit->is_open && refit->rest.w > 0) {
        (void)sh_posterior_take(&refit->posterior, refit->rest.x, size, refit->rest.w);
    }
}

void sh_refit_drop_trial(sh_refit *refit)
{
    refit->trial = 0;
}

void sh_refit_close(sh_refit *refit)
{
    refit->is_open = 0;
}

int sh_refit_end(sh_refit *refit, const sh_columns *columns, const sh_signals *signals, sh_real N,
                 const sh_parameters *p)
{
    refit->trial =
        refit->trial == 0 && N >= SH_FIRST_TRIAL ? next_trial(refit, columns, signals, p) : 0;
    refit->pause = 0;
    return refit->trial != 0;
}

/* A refit changes the estimate only little before there are enough blocks. */
int sh_refit_is_due(const sh_refit *refit, sh_real N, sh_real duration)
{
    const sh_real pause = N < SH_FIRST_TRIAL ? SH_FIRST_PAUSE : SH_REFIT_PAUSE * N * duration;

    return refit->pause >= pause;
}
