"""Builds what is released: FMUs, system, C library as one pair of files, Modelica package, wheels.

CMake runs each step as ``python -m sigmahat_build STEP``. The steps use the package `sigmahat`, and
the package does not use them: pip installs what they make, and not the steps themselves.
"""
