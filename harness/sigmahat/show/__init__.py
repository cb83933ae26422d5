"""Common parts of the figures of all commands: colours, style, and files."""
