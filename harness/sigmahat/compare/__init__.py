"""Both methods of the estimator, side by side, where motor data are wrong."""
