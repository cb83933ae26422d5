/* Replaces c/: its functions do everything that the functions of c/ may do. A state or parameters that they accept
 * carry a mark, and the functions that need it ask for it. Part 1 of the proof (tests/proof/library) covers the real
 * functions.
 *
 * Marks: p->method is one of the methods only after sh_parameters_check; estimator->started is 0 or 1 only after
 * sh_estimator_start or sh_estimator_check. Both marks are necessary conditions of the real functions.
 */
#include "shell_importer.h"
#include "sigmahat.h"

int sh_parameters_check(const sh_parameters *p, sh_violation *violation)
{
    if (p->method >= 1 && p->method <= 2 && any_choice()) {
        return 0;
    }
    violation->name = "rls.n";
    violation->value = any_real();
    violation->range = "1 to 8";
    return 1;
}

void sh_parameters_default_at(sh_parameters *p, sh_real samplePeriod)
{
    (void)samplePeriod;
    Frama_C_make_unknown((char *)p, sizeof *p);
}

/* Eva uses the results of a function again where all is the same that its code reads, and an assertion is
 * no code. So these compare in C.
 */
static void need_parameters(const sh_parameters *p)
{
    if (p->method < 1 || p->method > 2) {
        //@ assert checked: \false;
    }
}

static void need_state(const sh_estimator *estimator)
{
    if (estimator->started < 0 || estimator->started > 1) {
        //@ assert sound: \false;
    }
}

int sh_estimator_check(const sh_estimator *estimator, const sh_parameters *p)
{
    (void)p;
    return estimator->started < 0 || estimator->started > 1 || any_choice();
}

sh_real sh_parameters_largest_deformation(const sh_parameters *p)
{
    need_parameters(p);
    return any_real();
}

void sh_estimator_start(sh_estimator *estimator, const sh_parameters *p, sh_estimate *estimate)
{
    need_parameters(p);
    Frama_C_make_unknown((char *)estimator, sizeof *estimator);
    Frama_C_make_unknown((char *)estimate, sizeof *estimate);
    estimator->started = 0;
}

int sh_estimator_tick(sh_estimator *estimator, const sh_parameters *p, const sh_measurement *z,
                      sh_estimate *estimate)
{
    need_parameters(p);
    need_state(estimator);
    (void)z;
    Frama_C_make_unknown((char *)estimator, sizeof *estimator);
    Frama_C_make_unknown((char *)estimate, sizeof *estimate);
    estimator->started = any_choice();
    return any_choice();
}

void mark_checked(sh_estimator_fmu *model)
{
    model->parameters.method = Frama_C_interval(1, 2);
}

void mark_sound(sh_estimator_fmu *model)
{
    model->estimator.started = any_choice();
}

void expect_checked(const sh_estimator_fmu *model)
{
    need_parameters(&model->parameters);
}

void expect_sound(const sh_estimator_fmu *model)
{
    need_state(&model->estimator);
}
