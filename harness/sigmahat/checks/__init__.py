"""Checks that compare a configuration with its log, and find likely errors."""
