"""Creates the products of the build: FMUs, their documentation, and the amalgamation."""
