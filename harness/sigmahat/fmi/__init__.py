"""FMUs in Python: the installed FMUs, one instance, and the co-simulation master."""
