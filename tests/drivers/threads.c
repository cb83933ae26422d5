/* Runs eight instances one after the other, then with alternating steps, then each in its own
 * thread. The outputs must be the same, bit for bit.
 */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"
#include "fmi_calls.h"

enum { INSTANCES = 8, STEPS = 200, OUTPUTS = 256 };

typedef struct {
    int variant;
    double outputs[STEPS][OUTPUTS];
} run;

static void *run_alone(void *argument)
{
    run *own = argument;
    void *instance = start();
    long k;

    for (k = 0; k < STEPS; ++k) {
        step(instance, own->variant, k);
        get_outputs(instance, own->outputs[k]);
    }
    fmi_free_instance(instance);
    return NULL;
}

static run *new_runs(void)
{
    run *runs = calloc(INSTANCES, sizeof *runs);
    int i;

    check(runs != NULL, "calloc");
    for (i = 0; i < INSTANCES; ++i) {
        runs[i].variant = i;
    }
    return runs;
}

int main(void)
{
    run *separate = new_runs(), *in_turn = new_runs(), *in_threads = new_runs();
    void *instances[INSTANCES];
    pthread_t threads[INSTANCES];
    long k;
    int i;

    for (i = 0; i < INSTANCES; ++i) {
        run_alone(&separate[i]);
    }
    check(memcmp(separate[0].outputs, separate[1].outputs, sizeof separate[0].outputs) != 0,
          "the instances differ");

    for (i = 0; i < INSTANCES; ++i) {
        instances[i] = start();
    }
    for (k = 0; k < STEPS; ++k) {
        for (i = 0; i < INSTANCES; ++i) {
            step(instances[i], i, k);
            get_outputs(instances[i], in_turn[i].outputs[k]);
        }
    }
    for (i = 0; i < INSTANCES; ++i) {
        fmi_free_instance(instances[i]);
    }

    for (i = 0; i < INSTANCES; ++i) {
        check(pthread_create(&threads[i], NULL, run_alone, &in_threads[i]) == 0, "pthread_create");
    }
    for (i = 0; i < INSTANCES; ++i) {
        check(pthread_join(threads[i], NULL) == 0, "pthread_join");
    }

    check(memcmp(in_turn, separate, INSTANCES * sizeof *separate) == 0,
          "instances in turn give what they give alone");
    check(memcmp(in_threads, separate, INSTANCES * sizeof *separate) == 0,
          "instances in threads give what they give alone");
    free(separate);
    free(in_turn);
    free(in_threads);
    return 0;
}
