"""Paths of recorded data that are not in the repository."""

import os
from pathlib import Path

import pytest

from c_sources import REPOSITORY


def data_folder(name: str, first: str) -> Path:
    """../shared/data/NAME next to the checkout, or the folder that SIGMAHAT_NAME names.

    first  a file that must be there

    Raises FileNotFoundError if the path does not exist. If no folder is set, the test is skipped.
    """
    variable = f"SIGMAHAT_{name.upper()}"
    beside = REPOSITORY.parent / "shared" / "data" / name
    path = Path(os.environ.get(variable, beside))
    if not (path / first).is_file():
        text = f"no {name.upper()} data in {path}; {variable} can name another folder"
        if "PYTEST_CURRENT_TEST" in os.environ and variable not in os.environ:
            pytest.skip(text)
        raise FileNotFoundError(text)
    return path
