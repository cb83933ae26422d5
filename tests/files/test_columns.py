"""Titles of columns."""

from __future__ import annotations

import pytest

from sigmahat.files.tables import name_and_unit, title


@pytest.mark.parametrize(
    ("name", "unit", "text"),
    [
        ("sigma", "N.m/rad", "sigma [N.m/rad]"),
        ("MSE after 1 s", "(N.m/rad)2", "MSE after 1 s [(N.m/rad)2]"),
        ("eta[0,1]", "1", "eta[0,1] [1]"),
        ("valid", None, "valid"),
        ("eta[0,1]", None, "eta[0,1]"),
    ],
)
def test_a_title_is_read_as_it_was_written(name: str, unit: str | None, text: str) -> None:
    assert title(name, unit) == text
    assert name_and_unit(text) == (name, unit)
