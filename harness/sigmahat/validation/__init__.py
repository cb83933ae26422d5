"""Checks whether another log of the same joint confirms what was learned from a first log."""
