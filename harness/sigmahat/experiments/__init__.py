"""The engine: runs of scenarios over seeds, in parallel, and the evaluation of each run."""
