"""Guesses the meaning of the columns of a log, for the configuration by `sigmahat init`."""
