/* Every constant of the method FilteredRegression that is a choice: its unit, and why this value. */
#ifndef SH_CONSTANTS_H
#define SH_CONSTANTS_H

#include "real_math.h"

/* ---- filters, signals.c ------------------------------------------------------------------ */

/* Largest corner frequency divided by W_c of point 1 [1]. Above 2, the noise of y is not white. */
#define SH_LARGEST_CORNER ((sh_real)1.42)
/* Number of time constants 1/w after which the start of a filter counts as decayed [1]: 5e-4 of the start are left. */
#define SH_FORGOTTEN ((sh_real)12)
/* Change of phi in a sample, divided by the finer encoder resolution, below which phi counts as constant [1]. */
#define SH_RESTS ((sh_real)0.25)
/* Spacing of the rows divided by 1/w, and largest number of samples of a row [1]. The spacing 1.8 has the same results,
 * and the spacing 4.5 has 2 % larger errors. With 16 samples, a log of 10 s at 250 Hz has too few blocks.
 */
#define SH_ROW_SPACING ((sh_real)2.5)
#define SH_LONGEST_ROW 8
/* End of the range of regression.decimation [1]. */
#define SH_LARGEST_DECIMATION 64

/* ---- columns, columns.c ------------------------------------------------------------------ */

/* Half widths of dead zones and hysteresis, divided by range.phi [1]. One of the three is near any width. */
#define SH_DEAD_ZONES {(sh_real)0.01, (sh_real)0.04, (sh_real)0.16}
#define SH_HYSTERESES {(sh_real)0.005, (sh_real)0.02, (sh_real)0.08}
/* Share of the covered range above which a half width looks like the spring [1]. Half this share doubles the error. */
#define SH_LOOKS_LIKE_SPRING ((sh_real)0.25)
/* Stiffness within the widest dead zone divided by the stiffness outside [1]. Below this ratio, the zone is a gap and
 * no part of sigma; otherwise, the zone is a knee. A knee of harmonic drives has the ratio 0.5.
 */
#define SH_GAP ((sh_real)0.3)
/* Deformation at a possible knee divided by range.phi [1]. Harmonic drives have a knee at 1/3 of the largest torque. */
#define SH_POSSIBLE_KNEE ((sh_real)0.35)
/* Error of the deformation at a knee, divided by range.phi [1]: `sigmahat identify` finds this deformation to 0.01. */
#define SH_PLACE_OF_KNEE ((sh_real)0.02)
/* Relative std deviation of sigma below which the columns that are computed from sigma are used [1]. */
#define SH_KNOWN_STIFFNESS ((sh_real)0.2)
/* Largest delay that the column of the delay corrects, in std deviations of the delay's prior [1]. */
#define SH_LARGEST_DELAY ((sh_real)3)
/* Largest entry of a column of the motor encoder [N.m]: a wrong stiffness must not make every row too large. */
#define SH_LARGEST_ENCODER_ERROR SH_FOR(SH_REAL, 1e74, 1e14f)

/* ---- weight of a sample, noise.c --------------------------------------------------------- */

/* Share of excess noise in the variance of a row [1]. With 0.1, intervals are too narrow under jitter; with 1, too
 * wide.
 */
#define SH_EXCESS ((sh_real)0.3)
/* Share of the rounding variance count^2/12 that fourth differences do not show [1]: mean for 1 to 100 counts. */
#define SH_ROUNDING_IS_NOT_WHITE ((sh_real)0.056)
/* Time constant of the measured noise [s]. */
#define SH_NOISE_TIME ((sh_real)0.1)
/* Number of std deviations above which the first rows contradict the assumption that the motor is at rest [1]. */
#define SH_AT_REST ((sh_real)5)

/* Error of phi from encoder harmonics and gear, divided by the once-per-turn error of the link encoder [1]. With 0.025,
 * the estimate of a stiff joint with a free inertia is confident and wrong.
 */
#define SH_HARMONICS ((sh_real)0.035)
/* Largest change of the stiffness by these position errors, in std deviations of the stiffness [1]. */
#define SH_LARGEST_PULL ((sh_real)2)

/* ---- noise in columns, columns.c and posterior.c ----------------------------------------- */

/* Variance of the squared noise divided by the square of the mean of the squared noise [1]: the noise is correlated. */
#define SH_SPREAD_OF_SQUARE ((sh_real)6)
/* Relative error of the information that is removed as noise [1]: the rounding error repeats with the motion. */
#define SH_REMOVAL_ERROR ((sh_real)0.05)
/* Largest share of torque noise that passes through the column of the motor torque [1]: ten times expected friction. */
#define SH_LARGEST_RETURN ((sh_real)0.5)
/* Relative error of the variance of the torque noise [1]: noise.tau is known to 10 %. */
#define SH_TORQUE_NOISE_ERROR ((sh_real)0.2)
/* Least share of the information after the removal of noise [1]. A smaller share would be a rounding error in float. */
#define SH_LEAST_REST ((sh_real)1e-3)

/* ---- misfit and forgetting, misfit.c ----------------------------------------------------- */

/* Duration of a block [s]: several times 1/w, and short compared with a motion. */
#define SH_BLOCK ((sh_real)0.05)
/* Least and largest number of rows of a block [1]: sh_blocks_start computes K filter steps for each row. */
#define SH_SHORTEST_BLOCK ((sh_real)4)
#define SH_LONGEST_BLOCK ((sh_real)100000)
/* Number of blocks below which the misfit is not computed [1]: three blocks may have large errors by chance. */
#define SH_FEW_BLOCKS ((sh_real)4)
/* Number of blocks below which no data are forgotten [1]. */
#define SH_FIRST_BLOCKS ((sh_real)20)
/* Squared misfit above which the estimate is in doubt, and number of blocks below which this limit holds [1]. With more
 * blocks, most columns that may explain the misfit have been tried, and the variance factor is sufficient.
 */
#define SH_UNEXPLAINED ((sh_real)2.25)
#define SH_UNTRIED_BLOCKS ((sh_real)35)
/* With N blocks, the variance is multiplied by 1 + SH_UNJUDGED_BLOCKS / N [1]. In the first half second, joints with
 * several misfits are then wrong for 1.4 % (without the factor, 4.6 %) of the confident time.
 */
#define SH_UNJUDGED_BLOCKS ((sh_real)10)
/* Largest effective number of blocks [1]: 100 s, so that a misfit that begins after hours is noticed soon. */
#define SH_MOST_BLOCKS ((sh_real)2000)
/* Number of std deviations above which a sum of squared errors is not due to chance [1]. */
#define SH_CHANCE ((sh_real)3)
/* Number of blocks over which a misfit averages out [1]. Over more blocks, the misfit repeats with the motion. */
#define SH_REPEATS ((sh_real)5)
/* Variance factor above which data are forgotten, and a doubt is reported as a misfit [1]. */
#define SH_CONTRADICTION ((sh_real)1.5)
/* regression.memory divided by the time constant of the recent blocks [1]. */
#define SH_RECENT ((sh_real)10)
/* Ratio of the misfit and the usual misfit above which data are forgotten faster [1]. With the ratio 1, a second run of
 * an industrial robot, with other friction, makes the estimator forget the first run.
 */
#define SH_FAR_FROM_USUAL ((sh_real)3)
/* Factor by which data are forgotten faster if the recent blocks agree with each other [1]: the joint has changed. */
#define SH_FASTER ((sh_real)5)
/* Process noise of drifting friction, divided by the variance of the friction's prior [1/s]. */
#define SH_FRICTION_DRIFT ((sh_real)1e-3)
/* Residual with drifting friction divided by the residual with constant friction [1]. Friction counts as drifting below
 * the first ratio, and as constant above the second ratio.
 */
#define SH_DRIFT_BEGINS ((sh_real)0.8)
#define SH_DRIFT_ENDS ((sh_real)0.95)

/* ---- change of spring or friction, change.c ---------------------------------------------- */

/* Evidence above which the estimate is in doubt, and evidence above which a change is detected [1]. The second number
 * is multiplied by the square root of the usual squared error. Without a change, one of 3860 runs of 22 s with every
 * misfit reported a change. With 60 in place of 75, one of 1930 runs reported a change.
 */
#define SH_MAY_HAVE_CHANGED ((sh_real)20)
#define SH_HAS_CHANGED ((sh_real)75)
/* Largest evidence of one block, which is divided by the usual misfit, and the lower limit of this quotient [1]. One
 * block alone, which may be an impact, is then no change. With 25 for both numbers, a sixth fewer changes are found.
 * With 50 for both numbers, 300 simulated runs had 17 false changes instead of 10.
 */
#define SH_LARGEST_EVIDENCE ((sh_real)50)
#define SH_LEAST_LIMIT_OF_EVIDENCE ((sh_real)25)
/* Difference of the squared errors, in usual errors, above which one hypothesis is clearly better [1]: another spring,
 * or other friction. After SH_BLOCKS_TO_DECIDE blocks, any difference decides. With the difference 10, or with 8
 * blocks, twice as many of 160 simulated changes of friction are reported as changes of the spring. The difference 25
 * delays the estimate of a changed spring by 0.1 s.
 */
#define SH_CLEARLY_BETTER ((sh_real)25)
#define SH_BLOCKS_TO_DECIDE ((sh_real)20)
/* Squared error, in usual errors, above which a block contradicts the changed spring [1]: 3.5 std deviations. */
#define SH_CONTRADICTS ((sh_real)12.5)
/* Number of blocks in the mean that is the usual squared error, and largest value of one block in this mean, in usual
 * errors [1]. With these numbers, a change is found before its error becomes the usual error.
 */
#define SH_LEVEL_BLOCKS ((sh_real)400)
#define SH_LARGEST_LEVEL ((sh_real)9)
/* Ratio of the misfit and the usual misfit above which the estimate is in doubt [1]. The usual misfit is known after
 * SH_USUAL_BLOCKS blocks, or 15 s. With the ratio 1.5, the estimate of logs without a change is in doubt for 4 % of the
 * time. With the ratio 2, twice as many changes are not noticed for more than 1 s.
 */
#define SH_SUDDEN_MISFIT ((sh_real)1.7)
#define SH_USUAL_BLOCKS ((sh_real)300)
/* Number of blocks after which the hypothesis of a changed spring starts again [1]: 4 s. */
#define SH_LONGEST_TEST ((sh_real)80)
/* Least number of blocks for the detection of a change [1]. */
#define SH_SHORTEST_PAST ((sh_real)40)

/* ---- refits and choice of columns, refit.c ----------------------------------------------- */

/* Pause between two refits, divided by the duration of the counted blocks [1]. In 1 % more time, the estimate can
 * hardly change. The number is no simple ratio of blocks and rows, so that rounding errors have no effect.
 */
#define SH_REFIT_PAUSE ((sh_real)0.0101)
/* Duration of a row for each step of a refit in one step of the row [s], and largest number of these steps [1]. A row
 * below 13 ms has one step of the refit, and a row from 26 ms on has four. With one step in long rows, a wrong choice
 * of columns would last for 0.8 s at 250 Hz. A row of several samples has more samples than steps.
 */
#define SH_TIME_OF_STEP ((sh_real)0.0065)
#define SH_MOST_STEPS 4
/* Number of blocks from which refits try groups of columns [1]. With 15 blocks, the estimates of 360 random joints were
 * confident and over 20 % wrong for 0.42 % of the time. With 10 or 20, the share was 0.54 or 0.47 %.
 */
#define SH_FIRST_TRIAL ((sh_real)15)
/* Pause between two refits before groups are tried [s]. A refit removes noise (detail 14) and computes the misfit. */
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

/* ---- what is reported, filtered_regression.c --------------------------------------------- */

/* Limits of x^e and of x for x = |phi| / range.phi and the highest exponent e [1]. Beyond both limits, the estimate is
 * not confident.
 */
#define SH_LARGEST_POWER ((sh_real)32)
#define SH_LEAST_LIMIT ((sh_real)2)
/* Deviation of a motor parameter above which the estimate is in doubt, in std deviations of the prior [1]. */
#define SH_OUTSIDE_PRIOR ((sh_real)3)
/* Distance of viscous friction below 0 from which the estimate is in doubt, in std deviations [1]. Such a friction
 * shows that the encoders are read at different times. Of 40 simulated logs, only the eight with a late encoder had
 * such a friction.
 */
#define SH_BELOW_ZERO ((sh_real)1)

/* ---- limits of arithmetic ---------------------------------------------------------------- */

/* Initial precision of the data [1]: far below the precision 1 of a prior, but above rounding errors. */
#define SH_LEAST_INFORMATION SH_FOR(SH_REAL, 1e-9, 1e-5f)
/* Least entry of D [1]. An update that would make an entry of D smaller is left out, because 1/D would overflow. */
#define SH_SMALLEST_D SH_FOR(SH_REAL, 1e-300, 1e-37f)
/* Largest factor by which a step may increase a variance [1]. Beyond this factor, D would consist of rounding errors.
 */
#define SH_LARGEST_GROWTH SH_FOR(SH_REAL, 1e12, 1e6f)
/* Largest number of steps of a simulated filter response: the rows, and 60 time constants with the least w T, 1e-4. */
enum { SH_MOST_SAMPLES = 1000000 };

#endif
