"""Tests that need a tool that is not installed."""

from __future__ import annotations

import os
from typing import NoReturn

import pytest


def missing(what: str, how: str) -> NoReturn:
    """Ends the test: skips it. In the gate, which sets SIGMAHAT_GATE, the test fails instead.

    what  the tool, as in "<what> is not installed"
    how   command that installs it
    """
    text = f"{what} is not installed; to install it: {how}"
    if os.environ.get("SIGMAHAT_GATE"):
        pytest.fail(text)
    pytest.skip(text)
