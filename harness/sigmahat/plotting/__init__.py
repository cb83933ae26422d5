"""What the figures of all commands share: colours, style, and the files that are written."""
