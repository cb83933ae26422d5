"""Products of the build: FMUs, their documentation, the amalgamation."""
