"""The Modelica package: parsers read it, and its examples compile."""

from __future__ import annotations

import re

import pymoca.parser
import pytest
import rumoca

from modelica_package import FILES, PACKAGE, REPOSITORY, compiled


def test_two_parsers_read_every_file_without_error() -> None:
    for file in FILES:
        assert [each.message for each in rumoca.validate(file)] == []
        assert pymoca.parser.parse(file.read_text(encoding="utf-8")) is not None


EXAMPLES = sorted({file.stem for file in (PACKAGE / "Examples").glob("*.mo")} - {"package"})
WITH_ESTIMATORS = ("Antagonistic", "Table1", "page")
PAGE = REPOSITORY / "docs" / "how-to" / "modelica.md"


def text_of(example: str) -> tuple[str, str]:
    """Text and name of a model: an example, or the one on the page."""
    if example != "page":
        return f"model Test extends Sigmahat.Examples.{example}; end Test;", "Test"
    found = re.search(r"```modelica\n(model (\w+)\n.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert found
    return found[1], found[2]


@pytest.mark.parametrize("example", [*EXAMPLES, "page"])
def test_rumoca_compiles_every_example_as_far_as_it_can(example: str) -> None:
    """It knows no external objects: with an estimator it ends there, after names and arguments."""
    if example in WITH_ESTIMATORS:
        with pytest.raises(rumoca.CompileError, match=r"ToDae.* unsupported type `Estimator`"):
            compiled(*text_of(example))
    else:
        assert compiled(*text_of(example)).structure().is_balanced
