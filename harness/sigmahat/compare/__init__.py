"""Both methods of the estimator, side by side, on joints with wrong motor data."""
