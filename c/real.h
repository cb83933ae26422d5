/* The floating-point type of the whole library.
 *
 * It is double, or float if every file of the program that includes one of these headers is
 * compiled with -DSH_REAL=float. Constants that are not whole numbers are written as double and
 * converted by a cast, which costs nothing at run time.
 */
#ifndef SH_REAL_H
#define SH_REAL_H

#ifndef SH_REAL
#define SH_REAL double
#endif

typedef SH_REAL sh_real;

#define SH_PI 3.14159265358979323846

#endif
