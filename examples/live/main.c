/* Runs the estimator in a loop at 1 kHz under Linux and sends each estimate as a JSON datagram.
 *
 *     live [SECONDS [PORT]]      Defaults: 60 s, port 9871
 *
 * At the end the program prints the largest delay of the loop and the duration of the longest tick.
 */
#define _GNU_SOURCE

#include <arpa/inet.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include "robot.h"
#include "sigmahat.h"

#define PERIOD_NS 1000000
#define PRIORITY 80

static sh_parameters parameters;
static sh_estimator estimator; /* static, because an estimator is too large for many stacks */
static sh_estimate estimate;

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int start(void)
{
    sh_violation violation;
    sh_parameters_default_at(&parameters, (sh_real)(1e-9 * PERIOD_NS));
    parameters.method = SH_METHOD_FILTERED_REGRESSION;
    parameters.motor.gamma = (sh_real)robot_gear;
    parameters.motor.B = (sh_real)robot_B;
    parameters.motor.D_theta = (sh_real)robot_D_theta;
    parameters.prior.B = (sh_real)0.05; /* motor.B has a standard deviation of 5 % */
    parameters.range.phi = (sh_real)0.04;
    parameters.prior.tau_e = (sh_real)20;
    parameters.rls.m = 1; /* no motor sets the stiffness */
    if (sh_parameters_check(&parameters, &violation) != 0) {
        fprintf(stderr, "%s: expected %s, got %g\n", violation.name, violation.range,
                (double)violation.value);
        return 1;
    }
    sh_estimator_start(&estimator, &parameters, &estimate);
    return 0;
}

/* Requests real-time priority and locked memory. If the system denies both, the timing of the loop is less precise. */
static void ask_for_priority(void)
{
    const struct sched_param priority = {.sched_priority = PRIORITY};
    if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
        fprintf(stderr, "no SCHED_FIFO (%s): run it with the right to it, or by root\n",
                strerror(errno));
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        fprintf(stderr, "memory is not locked (%s)\n", strerror(errno));
    }
}

/* Sends an estimate as one line for PlotJuggler and `sigmahat`, also if no program receives it. */
static void send_estimate(int out, double t)
{
    char line[512];
    const int length = snprintf(
        line, sizeof line,
        "{\"timestamp\": %.6f, \"joint\": {\"sigma\": %.9g, \"sigma_std\": %.9g, \"tau_e\": %.9g, "
        "\"tau_e_std\": %.9g, \"phi\": %.9g, \"confident\": %s, \"doubt\": %d}}\n",
        t, (double)estimate.sigma, (double)estimate.sigma_std, (double)estimate.tau_e,
        (double)estimate.tau_e_std, (double)estimate.phi, estimate.confident ? "true" : "false",
        (int)estimate.doubt);
    (void)!write(out, line, (size_t)length);
}

static int connected(long port)
{
    const struct sockaddr_in to = {
        .sin_family = AF_INET,
        .sin_port = htons((uint16_t)port),
        .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
    };
    const int out = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    if (out < 0 || connect(out, (const struct sockaddr *)&to, sizeof to) != 0) {
        perror("socket");
        return -1;
    }
    return out;
}

int main(int count, char *arguments[])
{
    const double seconds = count > 1 ? atof(arguments[1]) : 60.0;
    const long port = count > 2 ? atol(arguments[2]) : 9871;
    if (!(seconds > 0.0 && seconds < 1e9) || port < 1 || port > 65535) {
        fprintf(stderr, "expected live [SECONDS [PORT]], seconds above 0, a port to 65535\n");
        return 2;
    }
    const int out = connected(port);
    const int timer = timerfd_create(CLOCK_MONOTONIC, 0);
    if (out < 0 || timer < 0 || start() != 0) {
        return 1;
    }
    ask_for_priority();

    const int64_t first = now_ns() + PERIOD_NS;
    const struct itimerspec every = {
        .it_value = {.tv_sec = (time_t)(first / 1000000000), .tv_nsec = (long)(first % 1000000000)},
        .it_interval = {.tv_nsec = PERIOD_NS},
    };
    timerfd_settime(timer, TFD_TIMER_ABSTIME, &every, NULL);
    const int64_t samples = (int64_t)(seconds * (1e9 / PERIOD_NS));
    int64_t missed = 0, latest = 0, longest = 0; /* [ns] */
    for (int64_t k = 0; k < samples; k++) {
        uint64_t periods = 0;
        if (read(timer, &periods, sizeof periods) != sizeof periods) {
            perror("timer");
            return 1;
        }
        for (; periods > 1 && k < samples; periods--, k++) { /* samples of a late loop are lost */
            const sh_measurement none = {.theta = (sh_real)NAN};
            (void)sh_estimator_tick(&estimator, &parameters, &none, &estimate);
            missed++;
        }
        const int64_t woken = now_ns();
        latest = larger(latest, woken - first - k * PERIOD_NS);

        const double t = 1e-9 * PERIOD_NS * (double)k;
        const robot_sample sample = robot_read(t);
        const sh_measurement z = {
            .theta = (sh_real)sample.theta, .q = (sh_real)sample.q, .tau = (sh_real)sample.tau};
        const int64_t before = now_ns();
        (void)sh_estimator_tick(&estimator, &parameters, &z, &estimate);
        longest = larger(longest, now_ns() - before);
        send_estimate(out, t);
    }
    printf("late by %" PRId64 " us at most; longest tick %" PRId64 " us\n", latest / 1000,
           longest / 1000);
    printf("%" PRId64 " of %" PRId64 " samples missed; stiffness %.5g +- %.2g N.m/rad, %s\n",
           missed, samples, (double)estimate.sigma, 1.96 * (double)estimate.sigma_std,
           estimate.confident ? "confident" : "not confident");
    return 0;
}
