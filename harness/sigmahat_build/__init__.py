"""Builds the products of the project: FMUs and their documentation, the C library in one pair of
files, the system, the Modelica package, the page in the browser, and the files of a release.

CMake runs each step as ``python -m sigmahat_build STEP``. These modules use the package `sigmahat`,
which does not use them: pip installs the products, and not the build.
"""
