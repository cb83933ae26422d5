"""The estimator on a robot: samples as they arrive, estimates as they are computed."""
