/* Marks a function that Python calls. */
#ifndef SH_EXPORT_H
#define SH_EXPORT_H

#ifdef _WIN32
#define SH_EXPORT __declspec(dllexport)
#else
#define SH_EXPORT __attribute__((visibility("default")))
#endif

#endif
