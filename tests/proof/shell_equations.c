/* In place of the equations that CasADi generated for a plant: they write any values to their results. */
#include "plant_functions.h"
#include "shell_importer.h"

static void any_results(double *to, int count)
{
    Frama_C_make_unknown((char *)to, (size_t)count * sizeof *to);
}

/*@ requires \valid_read(x + (0 .. n - 1)) && \initialized(x + (0 .. n - 1)); */
static void need(const double *x, int n)
{
    (void)x;
    (void)n;
}

/* A function of CasADi: how many results it has, and the sizes of its arguments. */
#define EQUATIONS(function, results, ...)                                                          \
    int function(const double **arg, double **res, int *iw, double *w, int mem)                    \
    {                                                                                              \
        const int sizes[] = {__VA_ARGS__};                                                         \
        int i;                                                                                     \
        /*@ loop unroll 4; */                                                                      \
        for (i = 0; i < (int)(sizeof sizes / sizeof *sizes); ++i)                                  \
            need(arg[i], sizes[i]);                                                                \
        any_results(res[0], results);                                                              \
        return 0;                                                                                  \
    }
EQUATIONS(sh_plant_start, SH_PLANT_STATES, SH_PLANT_PARAMETERS)
EQUATIONS(sh_plant_xdot, SH_PLANT_STATES, SH_PLANT_STATES, SH_PLANT_INPUTS, SH_PLANT_PARAMETERS)
EQUATIONS(sh_plant_outputs, SH_PLANT_OUTPUTS, SH_PLANT_STATES, SH_PLANT_INPUTS, SH_PLANT_PARAMETERS,
          SH_PLANT_NORMALS)
EQUATIONS(sh_plant_factorize, SH_PLANT_FACTORS, SH_PLANT_STATES, SH_PLANT_INPUTS,
          SH_PLANT_PARAMETERS, 3)
EQUATIONS(sh_plant_solve_real, SH_PLANT_STATES, SH_PLANT_FACTORS, SH_PLANT_STATES)

int sh_plant_solve_complex(const double **arg, double **res, int *iw, double *w, int mem)
{
    need(arg[0], SH_PLANT_FACTORS);
    need(arg[1], SH_PLANT_STATES);
    need(arg[2], SH_PLANT_STATES);
    any_results(res[0], SH_PLANT_STATES);
    any_results(res[1], SH_PLANT_STATES);
    return 0;
}

/* A plant needs no marks, because no number of a plant is used as an index or pointer. */
#define NO_MARK(function, type)                                                                    \
    void function(type *model)                                                                     \
    {                                                                                              \
        (void)model;                                                                               \
    }
NO_MARK(mark_checked, sh_plant)
NO_MARK(mark_sound, sh_plant)
NO_MARK(expect_checked, const sh_plant)
NO_MARK(expect_sound, const sh_plant)
