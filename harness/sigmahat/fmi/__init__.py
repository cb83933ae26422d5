"""FMUs in Python: where the installed ones are, one instance, and the co-simulation master."""
