"""The equation of a motor on a log: data of the motor, and hypotheses about a configuration.

`identify` asks for the values, `check` whether another configuration fits better, and `init` which
configuration fits.
"""
