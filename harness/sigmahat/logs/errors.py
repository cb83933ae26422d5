"""What is wrong with a log or its configuration."""


class LogError(ValueError):
    """Says in one line where the trouble is, what was expected, and what to do."""
