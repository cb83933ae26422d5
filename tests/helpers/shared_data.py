"""Where recorded data are that are not in the repository."""

import os
from pathlib import Path

from c_sources import REPOSITORY


def data_folder(name: str, first: str) -> Path:
    """../shared/data/NAME next to the checkout, or the folder that SIGMAHAT_NAME names.

    first  a file that must be there

    Raises FileNotFoundError if it is not.
    """
    variable = f"SIGMAHAT_{name.upper()}"
    beside = REPOSITORY.parent / "shared" / "data" / name
    path = Path(os.environ.get(variable, beside))
    if not (path / first).is_file():
        raise FileNotFoundError(
            f"no {name.upper()} data in {path}; {variable} can name another folder"
        )
    return path
