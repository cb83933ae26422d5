"""Runs of scenarios over seeds and parameters, in parallel."""
