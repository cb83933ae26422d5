"""The C library on arrays, without an FMU between."""
