/* The floating-point type of the whole library.
 *
 * double, unless every file of a program is compiled with -DSH_REAL=float.
 */
#ifndef SH_REAL_H
#define SH_REAL_H

#ifndef SH_REAL
#define SH_REAL double
#endif

typedef SH_REAL sh_real;

#endif
