"""The engine: runs of scenarios over seeds, in parallel, and what is computed of each."""
