"""Compares both methods of the estimator on joints with wrong motor data."""
