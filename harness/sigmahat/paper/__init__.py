"""The scenarios of the paper, and the results of `sigmahat reproduce`."""
