"""Joints in a physics engine that we did not write: MuJoCo."""
