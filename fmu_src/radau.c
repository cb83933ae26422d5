#include "radau.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "plant_functions.h"

enum { STATES = SH_PLANT_STATES, INPUTS = SH_PLANT_INPUTS, STAGES = 3 };
enum { MAX_NEWTON_ITERATIONS = 10, MAX_FOLLOWERS = 8 };

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
enum { MAX_ATTEMPTS = 1000 }; /* a fuzzer finds steps that need all attempts */
#else
enum { MAX_ATTEMPTS = 1000000 };
#endif
static const double FOR_A_TRANSIENT = 10000, PER_SECOND = 1e6;

static const double SCALE[STATES] = SH_PLANT_SCALES;
static const double ERROR_TOLERANCE = 1e-8;
/* Errors of Newton's iteration add up over the steps. The change in the last iteration is usually
 * smaller than this tolerance by orders of magnitude.
 */
static const double NEWTON_TOLERANCE = 1e-12;

/* Nodes (4 -+ sqrt(6)) / 10 and 1. */
static const double NODE[STAGES] = {0.15505102572168219, 0.64494897427831781, 1.0};

/* The inverse of the Runge-Kutta matrix is T diag(REAL, [RE -IM; IM RE]) T^-1. */
static const double REAL = 3.6378342527444957, RE = 2.6810828736277521, IM = 3.0504301992474105;
static const double T[STAGES][STAGES] = {
    {0.091232394870892943, -0.14125529502095421, -0.030029194105147424},
    {0.24171793270710702, 0.20412935229379993, 0.38294211275726194},
    {0.96604818261509294, 1.0, 0.0}};
static const double T_INVERSE[STAGES][STAGES] = {
    {4.3255798900631553, 0.33919925181580987, 0.54177053993587488},
    {-4.1787185915519047, -0.32768282076106239, 0.47662355450055045},
    {-0.50287263494578688, 2.5719269498556054, -0.59603920482822493}};

/* Weights of the stages in the error estimate, (-13 -+ 7 sqrt(6)) / 3 and -1/3. */
static const double DEFECT[STAGES] = {-10.048809399827416, 1.3821427331607489,
                                      -0.33333333333333333};

/* f(x, u, p) */
static void evaluate(const double *x, const double *u, const double *p, double *f)
{
    const double *arguments[] = {x, u, p};

    (void)sh_plant_xdot(arguments, &f, NULL, NULL, 0);
}

/* Factors of REAL/h - J and of (RE + i IM)/h - J, where J = df/dx. */
static void factorize(const double *x, const double *u, const double *p, double h, double *factors)
{
    const double shifts[] = {REAL / h, RE / h, IM / h};
    const double *arguments[] = {x, u, p, shifts};

    (void)sh_plant_factorize(arguments, &factors, NULL, NULL, 0);
}

/* b becomes (REAL/h - J)^-1 b. */
static void solve_real(const double *factors, double *b)
{
    const double *arguments[] = {factors, b};

    (void)sh_plant_solve_real(arguments, &b, NULL, NULL, 0);
}

/* re + i im becomes ((RE + i IM)/h - J)^-1 (re + i im). */
static void solve_complex(const double *factors, double *re, double *im)
{
    const double *arguments[] = {factors, re, im};
    double *results[] = {re, im};

    (void)sh_plant_solve_complex(arguments, results, NULL, NULL, 0);
}

/* Largest |v| weight; not a number if one of v is not. */
static double norm(const double *v, const double *weight)
{
    double largest = 0.0;
    int j;

    for (j = 0; j < STATES; ++j) {
        const double size = fabs(v[j]) * weight[j];
        if (isnan(size)) {
            return size;
        }
        if (size > largest) {
            largest = size;
        }
    }
    return largest;
}

/* to = matrix from */
static void transform(const double (*matrix)[STAGES], double (*from)[STATES], double (*to)[STATES])
{
    int i, j;

    for (i = 0; i < STAGES; ++i) {
        for (j = 0; j < STATES; ++j) {
            to[i][j] =
                matrix[i][0] * from[0][j] + matrix[i][1] * from[1][j] + matrix[i][2] * from[2][j];
        }
    }
}

/* Whether the inputs are constant. */
static int are_held(const double *du)
{
    int j;

    for (j = 0; j < INPUTS; ++j) {
        if (du[j] != 0.0) {
            return 0;
        }
    }
    return 1;
}

/* F_i = f(x + Z_i) at the nodes of a step */
static void evaluate_stages(const double *x, const double *u, const double *du, const double *p,
                            double h, double (*Z)[STATES], double (*F)[STATES])
{
    int i, j;

    for (i = 0; i < STAGES; ++i) {
        double x_i[STATES], u_i[INPUTS];
        for (j = 0; j < STATES; ++j) {
            x_i[j] = x[j] + Z[i][j];
        }
        for (j = 0; j < INPUTS; ++j) {
            u_i[j] = u[j] + du[j] * (NODE[i] * h);
        }
        evaluate(x_i, u_i, p, F[i]);
    }
}

/* Finds Z with Z_i = h sum_k a_ik f(x + Z_k) by Newton's iteration from Z = 0, with the Jacobian at
 * x for all stages. In the variables W = T^-1 Z it separates into a real and a complex system.
 * Returns 0 if the iteration does not converge.
 *
 * f       at x, under the inputs u
 * weight  of the states in the norm of a change
 */
static int solve_stages(const double *x, const double *u, const double *du, const double *p,
                        double h, const double *f, const double *weight, const double *factors,
                        double (*Z)[STATES])
{
    const int held = are_held(du);
    double W[STAGES][STATES] = {{0.0}}, F[STAGES][STATES], dW[STAGES][STATES];
    double change = INFINITY;
    int iteration, i, j;

    transform(T, W, Z);
    for (iteration = 0; iteration < MAX_NEWTON_ITERATIONS; ++iteration) {
        const double previous = change;

        if (iteration == 0 && held) { /* all stages are still at x */
            for (i = 0; i < STAGES; ++i) {
                (void)memcpy(F[i], f, sizeof F[i]);
            }
        } else {
            evaluate_stages(x, u, du, p, h, Z, F);
        }
        transform(T_INVERSE, F, dW);
        for (j = 0; j < STATES; ++j) {
            dW[0][j] -= REAL * W[0][j] / h;
            dW[1][j] -= (RE * W[1][j] - IM * W[2][j]) / h;
            dW[2][j] -= (IM * W[1][j] + RE * W[2][j]) / h;
        }
        solve_real(factors, dW[0]);
        solve_complex(factors, dW[1], dW[2]);
        for (i = 0; i < STAGES; ++i) {
            for (j = 0; j < STATES; ++j) {
                W[i][j] += dW[i][j];
            }
        }
        transform(T, W, Z);

        change = norm(dW[0], weight) + norm(dW[1], weight) + norm(dW[2], weight);
        if (change <= NEWTON_TOLERANCE) {
            return 1;
        }
        /* The changes shrink by a constant factor; the error is the sum of the changes to come.
         * Where f jumps by more than its size, the change grows once, even in a very short step.
         * This is allowed as long as the change is below the allowed error of the step.
         */
        if (iteration > 0) {
            const double rate = change / previous;
            if (rate < 1.0 && rate / (1.0 - rate) * change <= NEWTON_TOLERANCE) {
                return 1;
            }
            if (!(rate < 1.0) && !(change < ERROR_TOLERANCE)) {
                return 0;
            }
        }
    }
    return 0;
}

/* Estimated error of a step with the stages x + Z, as a multiple of the allowed error. It is the part that remains
 * after `followers` more steps of this length.
 *
 * A motion that decays in these steps need not be resolved. A step multiplies a mode by R(z), where
 * the exact solution has exp(z). On the whole negative axis R(z) is below 1 / (1 - z / REAL), and
 * the factors give this bound for all modes at once.
 *
 * f  at the begin of the step
 */
static double estimate_error(double (*Z)[STATES], const double *f, const double *weight, double h,
                             int followers, const double *factors)
{
    double error[STATES], size;
    int j;

    /* error = (REAL/h - J)^-1 (f(x) + defect) */
    for (j = 0; j < STATES; ++j) {
        error[j] = f[j] + (DEFECT[0] * Z[0][j] + DEFECT[1] * Z[1][j] + DEFECT[2] * Z[2][j]) / h;
    }
    solve_real(factors, error);
    size = norm(error, weight) / ERROR_TOLERANCE;
    /* `size` counts fast modes fully. But the step itself also damps these modes. */
    for (; followers >= 0 && size > 1.0; --followers) {
        for (j = 0; j < STATES; ++j) {
            error[j] *= REAL / h;
        }
        solve_real(factors, error);
        size = norm(error, weight) / ERROR_TOLERANCE;
    }
    return size;
}

/* One step from x to x_new, with factors for its length h. Returns the error that is left after `followers` more
 * steps of this length, as a multiple of the allowed error: the largest over the states. Without a solution, it is
 * infinite or not a number.
 */
static double take(const double *x, const double *u, const double *du, const double *p, double h,
                   int followers, const double *factors, double *x_new)
{
    double Z[STAGES][STATES], f[STATES], weight[STATES];
    int j, solved;

    evaluate(x, u, p, f);
    for (j = 0; j < STATES; ++j) {
        weight[j] = 1.0 / (SCALE[j] + fabs(x[j]));
    }
    solved = solve_stages(x, u, du, p, h, f, weight, factors, Z);
    for (j = 0; j < STATES; ++j) {
        x_new[j] = x[j] + Z[STAGES - 1][j];
    }
    return solved ? estimate_error(Z, f, weight, h, followers, factors) : INFINITY;
}

int sh_radau_attempts(double duration)
{
    return (int)fmin(FOR_A_TRANSIENT + PER_SECOND * duration, MAX_ATTEMPTS);
}

int sh_radau_integrate(double *x, const double *u, const double *du, const double *p,
                       double duration, double *h)
{
    /* Far below any time constant, far above the rounding of the time. */
    const double shortest = 1e-12 * (1.0 + duration);
    double elapsed = 0.0, begin = INFINITY;             /* suggested after the first step */
    double factors[SH_PLANT_FACTORS], factorized = 0.0; /* for steps of this length */
    const int allowed = sh_radau_attempts(duration);
    int attempt, steps = 0, owed = 0, j;

    for (attempt = 0; attempt < allowed; ++attempt) {
        const double left = duration - elapsed;
        const double wanted = left > *h ? ceil(left / *h) : 1.0;
        /* All steps of a plan are made. Only a plan of at least MAX_FOLLOWERS steps may change. */
        const double pieces = owed > 0 && owed < MAX_FOLLOWERS ? owed : fmax(wanted, owed);
        const double step = left / pieces;
        const int followers = (int)fmin(pieces - 1.0, MAX_FOLLOWERS);
        double u_now[INPUTS], x_new[STATES], error;

        for (j = 0; j < INPUTS; ++j) {
            u_now[j] = u[j] + du[j] * elapsed;
        }
        /* Steps that were planned together have the same length and use the same factors. */
        if (owed == 0 || fabs(step - factorized) > 1e-9 * step) {
            factorize(x, u_now, p, step, factors);
            factorized = step;
        }
        error = take(x, u_now, du, p, step, followers, factors, x_new);
        /* The error estimate falls with the fourth power of the step. */
        *h = step * fmin(8.0, fmax(0.2, 0.9 / sqrt(sqrt(error))));
        if (error <= 1.0) {
            (void)memcpy(x, x_new, sizeof x_new);
            elapsed += step;
            ++steps;
            owed = followers;
            if (pieces <= 1.0) {
                *h = fmin(*h, begin); /* the next call may begin with the same transient */
                return steps;
            }
            if (steps == 1) {
                begin = *h;
            }
        } else if (step <= shortest) {
            return 0;
        } else {
            owed = 0;
        }
    }
    return 0;
}
