"""Makes an FMU of a plant of the user's own, and has what all FMUs are made of.

The build of the package's own FMUs is no part of the package. It uses the modules of this room.
"""
