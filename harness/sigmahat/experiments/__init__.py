"""The engine of experiments: runs of plans over seeds, their records, and scores of estimates."""
