"""Runs the estimator on a robot, with estimates in real time."""
