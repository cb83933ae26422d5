"""Hypotheses about a configuration: which other sign, unit, gear or delay fits a log better."""
