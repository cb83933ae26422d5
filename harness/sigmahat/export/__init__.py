"""What the build makes of the sources: FMUs, their documentation, the amalgamation."""
