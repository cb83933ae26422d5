"""The C library for arrays, without an FMU."""
