/* An instance whose variables are read and written. */
#ifndef SHELL_ACCESS_H
#define SHELL_ACCESS_H

#include <stdlib.h>

#include "__fc_builtin.h"
#include "instance.h"
#include "shell_importer.h"

/*@ requires \valid(instance) && \valid_read(format);
    assigns \nothing; */
void sh_log(sh_instance *instance, sh_status status, const char *format, ...);

/* StiffnessEstimator: an input, a guess, an output, an array, an element of it, the three kinds of
 * outputs that are no Real, parameters of each type, the last variable, time, and none.
 */
static const uint32_t EVERY_KIND[] = {0, 5, 9, 14, 15, 72, 73, 79, 80, 97, 98, 165, 166, 167};

static MODEL model;
static char name[] = "x";

/* Before initialisation, or between steps: nothing is computed when a variable is read. */
static sh_instance any_instance(void)
{
    sh_instance instance = {0};

    Frama_C_make_unknown((char *)&model, sizeof model);
    instance.name = name;
    instance.categories = (unsigned)any_int();
    instance.state = any_choice() ? SH_STEP : SH_INSTANTIATED;
    instance.time = any_real();
    instance.model = &model;
    return instance;
}

#endif
