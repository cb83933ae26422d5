"""The page in which a log is set up: what the commands do, in a browser."""
