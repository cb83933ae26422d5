"""A tool that a test needs and this machine does not have."""

from __future__ import annotations

import os
from typing import NoReturn

import pytest


def missing(what: str, how: str) -> NoReturn:
    """Ends the test: skips it, but fails it in the gate, which sets SIGMAHAT_GATE.

    what  the tool, as in "<what> is not installed"
    how   command that installs it
    """
    text = f"{what} is not installed; to install it: {how}"
    if os.environ.get("SIGMAHAT_GATE"):
        pytest.fail(text)
    pytest.skip(text)
