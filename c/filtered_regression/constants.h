/* Every constant of the method FilteredRegression that is a choice: its unit, and why this value. */
#ifndef SH_CONSTANTS_H
#define SH_CONSTANTS_H

#include "real_math.h"

/* ---- filters, signals.c ------------------------------------------------------------------ */

/* Largest corner frequency over W_c of point 1 [1]: from 1 to 2 little differs; above, y has no white noise. */
#define SH_LARGEST_CORNER ((sh_real)1.42)
/* Time constants 1/w after which a filter has forgotten its start [1]: 5e-4 of it are left. */
#define SH_FORGOTTEN ((sh_real)12)
/* Change of phi in a sample, over the finer resolution, below which phi rests [1]: less than a count. */
#define SH_RESTS ((sh_real)0.25)
/* Spacing of the rows over 1/w, and largest number of samples of a row [1]. A spacing of 1.8 has the same results, and
 * 4.5 has 2 % larger errors. With 16 samples, a log of 10 s at 250 Hz has too few blocks.
 */
#define SH_ROW_SPACING ((sh_real)2.5)
#define SH_LONGEST_ROW 8
/* End of the range of regression.decimation [1]. */
#define SH_LARGEST_DECIMATION 64

/* ---- columns, columns.c ------------------------------------------------------------------ */

/* Half widths over range.phi [1]: each four times the one before, so that three come near any width. */
#define SH_DEAD_ZONES {(sh_real)0.01, (sh_real)0.04, (sh_real)0.16}
#define SH_HYSTERESES {(sh_real)0.005, (sh_real)0.02, (sh_real)0.08}
/* Share of the covered range from which such a width looks like the spring [1]: half of it doubles the error. */
#define SH_LOOKS_LIKE_SPRING ((sh_real)0.25)
/* Stiffness within the widest dead zone over the stiffness outside [1]. Below this ratio the zone is a gap and no part
 * of sigma, else it is a knee. A gap leaves 0, a knee of harmonic drives half.
 */
#define SH_GAP ((sh_real)0.3)
/* Place of a possible knee over range.phi [1]: harmonic drives have theirs at a third of the largest torque. */
#define SH_POSSIBLE_KNEE ((sh_real)0.35)
/* Error of the place of a knee, over range.phi [1]: identify finds it to 0.01. */
#define SH_PLACE_OF_KNEE ((sh_real)0.02)
/* Relative std deviation of sigma below which columns that need sigma have an effect [1]. */
#define SH_KNOWN_STIFFNESS ((sh_real)0.2)
/* Largest delay that the column of the delay corrects, in std deviations of its prior [1]. */
#define SH_LARGEST_DELAY ((sh_real)3)
/* Largest entry of a column of the motor encoder [N.m]: a wrong stiffness must not make every row too large. */
#define SH_LARGEST_ENCODER_ERROR SH_FOR(SH_REAL, 1e74, 1e14f)

/* ---- weight of a sample, noise.c --------------------------------------------------------- */

/* Share of the excess noise by which samples weigh less [1]: 0.1 covers jitter too rarely, 1 is too wide. */
#define SH_EXCESS ((sh_real)0.3)
/* Share of count^2/12 that fourth differences of rounding lack [1]: mean for 1 to 100 counts in a sample. */
#define SH_ROUNDING_IS_NOT_WHITE ((sh_real)0.056)
/* Time constant of the measured noise [s]. */
#define SH_NOISE_TIME ((sh_real)0.1)
/* Std deviations by which the first samples may contradict a motor at rest [1]. */
#define SH_AT_REST ((sh_real)5)

/* Errors of phi that repeat with the position, over the once-per-turn error of the link encoder [1]: harmonics, gear.
 * With 0.025, stiff joints under a free inertia are confident and wrong.
 */
#define SH_HARMONICS ((sh_real)0.035)
/* Largest change by such errors, in std deviations [1]. */
#define SH_LARGEST_PULL ((sh_real)2)

/* ---- noise in columns, columns.c and posterior.c ----------------------------------------- */

/* Variance of the squared noise over the square of its mean [1]: the noise is correlated. */
#define SH_SPREAD_OF_SQUARE ((sh_real)6)
/* Relative error of the removed information [1]: rounding repeats with the motion. */
#define SH_REMOVAL_ERROR ((sh_real)0.05)
/* Largest share of the noise that the motor's column returns [1]: ten times the friction that is expected. */
#define SH_LARGEST_RETURN ((sh_real)0.5)
/* Relative error of the variance of the torque's noise [1]: noise.tau is known to 10 %. */
#define SH_TORQUE_NOISE_ERROR ((sh_real)0.2)
/* Least share of the information that is left [1]: less would be rounding errors in single precision. */
#define SH_LEAST_REST ((sh_real)1e-3)

/* ---- misfit and forgetting, misfit.c ----------------------------------------------------- */

/* Duration of a block [s]: several times 1/w, and short beside a motion. */
#define SH_BLOCK ((sh_real)0.05)
/* Least and largest number of rows of a block [1]: sh_blocks_start makes K steps for each. */
#define SH_SHORTEST_BLOCK ((sh_real)4)
#define SH_LONGEST_BLOCK ((sh_real)100000)
/* Number of blocks below which there is no misfit [1]: three may have an error by chance. */
#define SH_FEW_BLOCKS ((sh_real)4)
/* Number of blocks below which nothing is forgotten [1]. */
#define SH_FIRST_BLOCKS ((sh_real)20)
/* Misfit, squared, that is a doubt with fewer than so many blocks [1]. With more blocks, most columns that may explain
 * the misfit have been tried, and the variance factor covers the rest.
 */
#define SH_UNEXPLAINED ((sh_real)2.25)
#define SH_UNTRIED_BLOCKS ((sh_real)35)
/* With N blocks, the variance counts 1 + this number / N times [1]. In the first half second, joints with several
 * misfits are then wrong for 1.4 % of the confident time. With the number 0, this was 4.6 %.
 */
#define SH_UNJUDGED_BLOCKS ((sh_real)10)
/* Number of blocks that count [1]: 100 s, so that a misfit that begins after hours is noticed soon. */
#define SH_MOST_BLOCKS ((sh_real)2000)
/* Std deviations beyond which a sum of squares is not due to chance [1]. */
#define SH_CHANCE ((sh_real)3)
/* Number of blocks up to which a misfit averages out; beyond it repeats with the motion [1]. */
#define SH_REPEATS ((sh_real)5)
/* Variance factor above which data are forgotten, and the doubt is a misfit [1]. */
#define SH_CONTRADICTION ((sh_real)1.5)
/* regression.memory over the time constant of the recent blocks [1]. */
#define SH_RECENT ((sh_real)10)
/* Misfit over its usual value above which data are forgotten faster [1]. With 1, an industrial robot's second run with
 * other friction makes the estimator forget the first run.
 */
#define SH_FAR_FROM_USUAL ((sh_real)3)
/* How much faster data are forgotten if the recent ones agree [1]: the joint has changed. */
#define SH_FASTER ((sh_real)5)
/* Process noise of friction that drifts, in variances of its prior [1/s]. */
#define SH_FRICTION_DRIFT ((sh_real)1e-3)
/* Residual of drifting over that of constant friction [1]: friction drifts below the first, and no longer above the
 * second.
 */
#define SH_DRIFT_BEGINS ((sh_real)0.8)
#define SH_DRIFT_ENDS ((sh_real)0.95)

/* ---- change of spring or friction, change.c ---------------------------------------------- */

/* Evidence above which the estimate is in doubt, and, times the root of its usual error, something has changed [1].
 * Without a change, one of 3860 runs of 22 s with every misfit reported one; with 60, one of 1930.
 */
#define SH_MAY_HAVE_CHANGED ((sh_real)20)
#define SH_HAS_CHANGED ((sh_real)75)
/* Largest evidence of one block, over the usual misfit, and with any misfit [1]: one block alone, which may be a blow,
 * is no change. With 25 throughout, a sixth fewer changes are found. With 50 throughout, 300 simulated runs had 17
 * false changes, and not 10.
 */
#define SH_LARGEST_EVIDENCE ((sh_real)50)
#define SH_LEAST_LIMIT_OF_EVIDENCE ((sh_real)25)
/* Difference of the squared errors, in usual errors, from which another spring is clearly better than other friction
 * [1]. After so many blocks any difference decides. With 10, or with 8 blocks, twice as many of 160 simulated changes
 * of friction are taken for a change of the spring. With 25, the estimate follows the spring 0.1 s later.
 */
#define SH_CLEARLY_BETTER ((sh_real)25)
#define SH_BLOCKS_TO_DECIDE ((sh_real)20)
/* Squared error of a block, in usual errors, that contradicts the changed spring [1]: 3.5 std deviations. */
#define SH_CONTRADICTS ((sh_real)12.5)
/* Number of blocks in the mean that is the usual error, and largest count of one block, in usual errors [1]. A change
 * is found before it becomes usual.
 */
#define SH_LEVEL_BLOCKS ((sh_real)400)
#define SH_LARGEST_LEVEL ((sh_real)9)
/* Misfit over its usual value above which the estimate is in doubt [1]. The usual value is known after so many blocks:
 * 15 s. With 1.5, logs without a change are in doubt for 4 % of the time. With 2, twice as many changes are not noticed
 * for over 1 s.
 */
#define SH_SUDDEN_MISFIT ((sh_real)1.7)
#define SH_USUAL_BLOCKS ((sh_real)300)
/* Number of blocks after which a hypothesis ends [1]: 4 s. */
#define SH_LONGEST_TEST ((sh_real)80)
/* Number of blocks from which a change can be seen [1]. */
#define SH_SHORTEST_PAST ((sh_real)40)

/* ---- refits and choice of columns, refit.c ----------------------------------------------- */

/* Pause between two refits, over the duration of the blocks that count [1]: in 1 % more time the estimate can
 * hardly change. No simple ratio of blocks and rows, so that no rounding error decides.
 */
#define SH_REFIT_PAUSE ((sh_real)0.0101)
/* Duration of a row for each step that a refit makes in a step of the row [s], and most of these steps [1]. There is
 * one step in rows below 13 ms, and four from 26 ms on. With one there, too, a wrong choice of columns would last for
 * 0.8 s at 250 Hz. Rows of several samples have more samples than steps.
 */
#define SH_TIME_OF_STEP ((sh_real)0.0065)
#define SH_MOST_STEPS 4
/* Number of blocks from which groups of columns are tried [1]. With 15, 360 random joints were confident and over 20 %
 * wrong for 0.42 % of the time. With 10, this was 0.54 %, and with 20 it was 0.47 %.
 */
#define SH_FIRST_TRIAL ((sh_real)15)
/* Pause before [s]: a refit then removes noise (detail 14), and judges the misfit. */
#define SH_FIRST_PAUSE ((sh_real)0.2)
/* Gain of the logarithm of the evidence from which a group is used: at first, and for each block [1]. So it
 * reduces the variance of the error by a tenth: rounding of a periodic motion is a small evidence for any
 * column.
 */
#define SH_FIRST_GAIN ((sh_real)3)
#define SH_GAIN_PER_BLOCK ((sh_real)0.05)
/* The same for possible knees [1]: beside coarse encoders, a knee that changes sigma by a third is a small evidence.
 * With 0.05, the interval held 84 % of the confident instants of such springs, with 0.01 89 %, and springs without
 * knees lose nothing.
 */
#define SH_KNEE_GAIN_PER_BLOCK ((sh_real)0.01)

/* ---- what is reported, filtered_regression.c --------------------------------------------- */

/* The estimate is not confident if x = |phi| / range.phi is above the second number and x^e above the first [1]. The
 * highest power is e.
 */
#define SH_LARGEST_POWER ((sh_real)32)
#define SH_LEAST_LIMIT ((sh_real)2)
/* Std deviations of its prior beyond which a corrected motor parameter is doubted [1]. */
#define SH_OUTSIDE_PRIOR ((sh_real)3)
/* Std deviations below 0 from which viscous friction is doubted [1]: encoders are then read at different times. Of 40
 * simulated logs, all eight with a late encoder had a friction below 0, and no other one.
 */
#define SH_BELOW_ZERO ((sh_real)1)

/* ---- limits of arithmetic ---------------------------------------------------------------- */

/* Precision with which data begin, where a prior has 1 [1]: far less, but no rounding error. */
#define SH_LEAST_INFORMATION SH_FOR(SH_REAL, 1e-9, 1e-5f)
/* An entry of D that would be smaller is not changed [1]: one over it would overflow. */
#define SH_SMALLEST_D SH_FOR(SH_REAL, 1e-300, 1e-37f)
/* Largest factor by which a step may increase a variance [1]: else D consists of rounding errors. */
#define SH_LARGEST_GROWTH SH_FOR(SH_REAL, 1e12, 1e6f)
/* Steps of the loop over the response of a filter: the rows and 60 time constants with the least w T, 1e-4. */
enum { SH_MOST_SAMPLES = 1000000 };

#endif
