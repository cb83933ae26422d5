/* A Modelica tool, as far as an external object needs one: constructor, ticks, destructor.
 *
 * calls.h is made from the Modelica sources: PROTOTYPES, NEW (the call of the constructor with the values
 * of the parameters), OUTPUTS (declarations), TICK(object, t, z), and WRITE (all outputs).
 *
 * Reads samples from stdin, each of t and the five inputs, and writes the outputs of every tick to
 * stdout, all as doubles in the format of this machine. Two objects run in turn; the second one sees all
 * inputs as 0, and its outputs are thrown away. With an argument every tick is made twice, first with
 * other inputs. An error of the model ends it with status 3.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include "ModelicaUtilities.h"
#include "calls.h"

static jmp_buf model;

void ModelicaError(const char *string)
{
    fputs(string, stderr);
    longjmp(model, 1);
}

void ModelicaFormatError(const char *string, ...)
{
    va_list arguments;

    va_start(arguments, string);
    vfprintf(stderr, string, arguments);
    va_end(arguments);
    longjmp(model, 1);
}

void ModelicaFormatMessage(const char *string, ...)
{
    va_list arguments;

    va_start(arguments, string);
    vfprintf(stderr, string, arguments);
    va_end(arguments);
}

static void put(const double *values, size_t count)
{
    fwrite(values, sizeof *values, count, stdout);
}

static void put_integer(int value)
{
    const double converted = value;

    put(&converted, 1);
}

int main(int count, char **arguments)
{
    static const double zero[5], others[5] = {1.0, 2.0, 3.0, 4.0, 5.0};
    double sample[6];
    void *object, *second;
    OUTPUTS;

    (void)arguments;
    if (setjmp(model) != 0) {
        return 3;
    }
    object = NEW;
    second = NEW;
    while (fread(sample, sizeof sample, 1, stdin) == 1) {
        if (count > 1) {
            TICK(object, sample[0], others);
        }
        TICK(second, sample[0], zero);
        TICK(object, sample[0], (sample + 1));
        WRITE;
    }
    sigmahat_estimator_free(second);
    sigmahat_estimator_free(object);
    return 0;
}
