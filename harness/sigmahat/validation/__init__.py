"""Checks whether another log of the same joint confirms the estimate from a first log."""
