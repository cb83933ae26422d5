/* In place of the equations that CasADi generated for a plant: they write any values to their
 * results.
 */
#include "__fc_builtin.h"
#include "plant_functions.h"
#include "shell_importer.h"

static int any_results(double *to, int count)
{
    Frama_C_make_unknown((char *)to, (size_t)count * sizeof *to);
    return 0;
}

/*@ requires \valid_read(x + (0 .. n - 1)) && \initialized(x + (0 .. n - 1)); */
static void need(const double *x, int n)
{
    (void)x;
    (void)n;
}

int sh_plant_start(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_PARAMETERS);
    return any_results(res[0], SH_PLANT_STATES);
}

int sh_plant_xdot(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_STATES);
    need(arg[1], SH_PLANT_INPUTS);
    need(arg[2], SH_PLANT_PARAMETERS);
    return any_results(res[0], SH_PLANT_STATES);
}

int sh_plant_outputs(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_STATES);
    need(arg[1], SH_PLANT_INPUTS);
    need(arg[2], SH_PLANT_PARAMETERS);
    need(arg[3], SH_PLANT_NORMALS);
    return any_results(res[0], SH_PLANT_OUTPUTS);
}

int sh_plant_factorize(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_STATES);
    need(arg[1], SH_PLANT_INPUTS);
    need(arg[2], SH_PLANT_PARAMETERS);
    need(arg[3], 3);
    return any_results(res[0], SH_PLANT_FACTORS);
}

int sh_plant_solve_real(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_FACTORS);
    need(arg[1], SH_PLANT_STATES);
    return any_results(res[0], SH_PLANT_STATES);
}

int sh_plant_solve_complex(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_FACTORS);
    need(arg[1], SH_PLANT_STATES);
    need(arg[2], SH_PLANT_STATES);
    any_results(res[0], SH_PLANT_STATES);
    return any_results(res[1], SH_PLANT_STATES);
}

/* A plant needs no marks: whatever its numbers are, they lead to no other memory. */
#define NO_MARK(function, type)                                                                    \
    void function(type *model)                                                                     \
    {                                                                                              \
        (void)model;                                                                               \
    }
NO_MARK(mark_checked, sh_plant)
NO_MARK(mark_sound, sh_plant)
NO_MARK(expect_checked, const sh_plant)
NO_MARK(expect_sound, const sh_plant)
