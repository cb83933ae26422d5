"""Compares FilteredRegression with other methods, on simulated logs of joints in MuJoCo."""
