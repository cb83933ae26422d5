/* The present block (F18): rows that follow each other without a gap, and whose weighted mean has an error that is
 * nearly independent of the error of the next block.
 */
#include "real_math.h"
#include "regression.h"
#include "state_variable_filter.h"

/* Duration of a block [s], short compared with a motion. Blocks are independent from w = 160 rad/s on. Below that
 * they are not, and the misfit of a right model grows to 1.6 at 22 rad/s. Blocks of 8/w would mend that, but a change at
 * 22 rad/s, which is found after 0.4 s, would then still be unknown after 13 s, because all times of the bank are
 * numbers of blocks.
 */
#define SH_BLOCK ((sh_real)0.05)
/* Least and largest number of rows of a block [1]: sh_block_start computes K filter steps for each row. */
#define SH_SHORTEST_BLOCK ((sh_real)4)
#define SH_LONGEST_BLOCK ((sh_real)100000)

void sh_block_start(sh_block *block, const sh_signals *signals)
{
    const sh_filter_design *design = &signals->design;
    const int K = signals->decimation;
    const sh_real row = (sh_real)K * design->T;

    block->length = sh_floor(SH_BLOCK / row + (sh_real)0.5);
    block->length = sh_fmin(sh_fmax(block->length, SH_SHORTEST_BLOCK), SH_LONGEST_BLOCK);
    block->duration = block->length * row;
    sh_state_variable_filter_noise(design, block->length, K, &block->energy, &block->energy_second);
}

void sh_block_empty(sh_block *block)
{
    int i;

    for (i = 0; i < SH_MAX_ROW; ++i) {
        block->sum[i] = 0;
    }
    block->rows = block->weight = block->weight_window = 0;
    block->window = block->window_square = block->independent = block->rounding = 0;
}

/* Returns the variance of the mean row of a block. White noise has the variance sum h^2 w / (sum h w)^2 times the share
 * that H leaves. The rounding of theta adds the variance of (gamma^2 B theta'')_f.
 */
static sh_real variance_of_block(const sh_block *block, const sh_signals *signals,
                                 const sh_parameters *p)
{
    const sh_real inertia = sh_is_measured(p) ? 0 : sh_square(p->motor.gamma) * p->motor.B;
    const sh_real rounding = sh_square(inertia) * block->rounding / block->rows;

    return block->weight_window / sh_square(block->weight) * block->energy +
           rounding * block->energy_second * block->window_square /
               (sh_square(block->window) * (sh_real)signals->decimation);
}

static void add_to_sums(sh_block *block, const sh_row *row, int size)
{
    const sh_real h = sh_window(block->rows, block->length), wh = row->w * h;
    int i;

    for (i = 0; i < size + SH_RIGHT_SIDES; ++i) {
        block->sum[i] += wh * row->x[i];
    }
    block->weight += wh;
    block->weight_window += wh * h;
    block->window += h;
    block->window_square += sh_square(h);
    block->independent += sh_square(h) / row->lasting; /* rows with the same error count as fewer */
    block->rounding += row->rough;
    block->rows += 1;
}

/* The mean row of a block is sum h w x / sum h w. */
static void set_mean(sh_block_mean *mean, const sh_block *block, const sh_signals *signals,
                     int size, const sh_parameters *p)
{
    const sh_real variance = variance_of_block(block, signals, p);
    const int count = size + SH_RIGHT_SIDES;
    int i;

    for (i = 0; i < count; ++i) {
        mean->x[i] = block->sum[i] / block->weight;
    }
    mean->count = block->independent / block->window_square;
    mean->duration = mean->count * block->duration;
    mean->w = 0;
    if (variance > 0 && sh_sum_of_products(mean->x, mean->x, count) / variance <= SH_LARGE) {
        mean->w = 1 / variance;
    }
}

int sh_block_take(sh_block *block, const sh_row *row, const sh_signals *signals, int size,
                  const sh_parameters *p, sh_block_mean *mean)
{
    add_to_sums(block, row, size);
    if (block->rows < block->length) {
        return 0;
    }
    set_mean(mean, block, signals, size, p);
    sh_block_empty(block);
    return mean->w > 0;
}
