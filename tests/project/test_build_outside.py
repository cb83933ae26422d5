"""The build of the products uses the package; the package works without the build."""

from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "harness" / "sigmahat"


def test_no_module_of_the_package_names_the_build() -> None:
    modules = list(PACKAGE.rglob("*.py"))
    assert modules
    for path in modules:
        assert "sigmahat_build" not in path.read_text(encoding="utf-8"), path
