"""The page to set up a log: the work of the commands, in a browser."""
