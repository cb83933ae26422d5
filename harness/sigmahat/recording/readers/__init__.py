"""Readers of the file formats of logs."""
