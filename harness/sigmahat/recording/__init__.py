"""Recorded logs: read, converted to the inputs of the estimator, replayed."""
