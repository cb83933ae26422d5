"""What in a configuration is likely wrong, by what the log itself shows."""
