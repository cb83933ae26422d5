"""The scenarios of the paper, and what `sigmahat reproduce` makes of them."""
