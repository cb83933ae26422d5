"""What the columns of a log are, guessed: the configuration that `sigmahat init` writes."""
