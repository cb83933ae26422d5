"""The error for a log or a configuration that cannot be used."""


class LogError(ValueError):
    """The message says in one line where the error is, what was expected, and what to do."""
