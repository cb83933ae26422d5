/* Instructions and stack of a tick.
 *
 * footprint METHOD TICKS   runs ticks; callgrind counts their instructions
 * footprint METHOD         prints the stack of a tick [bytes]: how much of a painted stack it changes
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tick.h"

enum { STACK = 1 << 20, SAMPLES = 2000, PAINT = 0xa5 };

static double z[SAMPLES][BENCH_MEASUREMENTS], outputs[3];

static double rounded(double angle, double counts)
{
    const double count = 2.0 * 3.14159265358979323846 / counts;

    return count * floor(angle / count + 0.5);
}

/* A joint that swings at 1 Hz, through its encoders. */
static void make_measurements(void)
{
    int k;

    for (k = 0; k < SAMPLES; ++k) {
        const double phase = 2.0 * 3.14159265358979323846 * 1e-3 * k;
        z[k][0] = rounded(0.2 * sin(phase), 40000.0);
        z[k][1] = rounded(0.2 * sin(phase) + 0.02 * cos(phase), 40000.0);
        z[k][2] = rounded(75.0 + 5.0 * sin(0.7 * phase), 1024.0);
        z[k][3] = 0.3 * sin(phase);
        z[k][4] = 6.0 * sin(phase);
    }
}

static void *nothing(void *ticks)
{
    return ticks;
}

static void *run(void *ticks)
{
    tick_run(ticks, z[0], SAMPLES, outputs);
    return NULL;
}

/* Bytes of a fresh stack that a thread has written to. */
static long used(void *(*function)(void *), void *argument)
{
    unsigned char *stack = NULL;
    pthread_attr_t attributes;
    pthread_t thread;
    long untouched = 0;

    if (posix_memalign((void **)&stack, 4096, STACK) != 0) {
        exit(1);
    }
    memset(stack, PAINT, STACK);
    pthread_attr_init(&attributes);
    if (pthread_attr_setstack(&attributes, stack, STACK) != 0 ||
        pthread_create(&thread, &attributes, function, argument) != 0) {
        exit(1);
    }
    pthread_join(thread, NULL);
    while (untouched < STACK && stack[untouched] == PAINT) {
        ++untouched;
    }
    free(stack);
    return STACK - untouched;
}

int main(int count, char **arguments)
{
    void *ticks = count > 1 ? tick_start(arguments[1]) : NULL;
    long left;

    if (ticks == NULL) {
        fprintf(stderr, "expected a method of the estimator\n");
        return 1;
    }
    make_measurements();
    if (count == 2) {
        run(ticks); /* the first call alone needs more, to find functions of libraries */
        printf("%ld\n", used(run, ticks) - used(nothing, ticks));
        return 0;
    }
    for (left = atol(arguments[2]); left > 0; left -= SAMPLES) {
        tick_run(ticks, z[0], left < SAMPLES ? (int)left : SAMPLES, outputs);
    }
    return 0;
}
