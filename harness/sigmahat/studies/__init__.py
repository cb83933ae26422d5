"""The studies of this package: plans for the engine of experiments, with their tables and panels.

Each plan is a file that can be copied and changed: `sweep`, `compare`, `misfits`, `reproduce`.
"""
