"""Figures 3 to 12 of the paper, and one picture for each scenario."""
