"""The scenarios of the paper, run by co-simulation; comparison of methods, tables, figures."""
