"""Recorded logs: read, converted to the ports of the estimator, and replayed through its FMU."""
