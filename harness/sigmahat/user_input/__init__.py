"""What users write: TOML files, and names that may not exist."""
