"""The bill of materials of the release; archives that are the same wherever they are packed."""

import hashlib
import json
import os
import shutil
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

import sigmahat
from released_fmus import FMUS
from sigmahat.export import bill, distribution, modelica

REPOSITORY = Path(__file__).parents[2]
OLD = 86400.0  # [s] since 1970


@pytest.fixture(scope="module")
def contents(released: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((released / bill.NAME).read_text(encoding="utf-8"))
    return found


def test_the_bill_fits_the_schema(released: Path) -> None:
    text = (released / bill.NAME).read_text(encoding="utf-8")
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(text) is None


def test_the_bill_has_every_file_of_the_release_with_its_hash(
    released: Path, contents: dict[str, Any]
) -> None:
    listed = {
        each["name"]: each["hashes"][0]["content"]
        for each in contents["components"]
        if each["type"] == "file"
    }
    other = {bill.NAME, "python.stamp"}
    files = [f for f in released.rglob("*") if f.is_file() and f.name not in other]
    expected = {
        f.relative_to(released).as_posix(): hashlib.sha256(f.read_bytes()).hexdigest()
        for f in files
    }
    assert listed == expected


def test_the_bill_says_what_is_in_a_file(contents: dict[str, Any]) -> None:
    inside = {each["ref"]: set(each.get("dependsOn", [])) for each in contents["dependencies"]}
    plant, estimator = inside["AwasPlant_FMI3.fmu"], inside["StiffnessEstimator.fmu"]
    assert plant - estimator == {"equations that CasADi wrote as C"}
    wheel = next(name for name in inside if name.endswith("win_amd64.whl"))
    assert {"numpy", "fmpy", "pyarrow"} <= inside[wheel]
    assert "ziglang" in {each["name"] for each in contents["metadata"]["tools"]["components"]}


def older(folder: Path, copy: Path) -> Path:
    """A copy of a folder whose files are of another time."""
    shutil.copytree(folder, copy)
    for file in copy.rglob("*"):
        os.utime(file, (OLD, OLD))
    return copy


def test_the_bill_is_the_same_from_another_folder(released: Path, tmp_path: Path) -> None:
    copy = older(released, tmp_path / "elsewhere")
    bill.write(copy / bill.NAME, copy, sigmahat.__version__)
    assert (copy / bill.NAME).read_bytes() == (released / bill.NAME).read_bytes()


def test_the_modelica_package_made_elsewhere_is_the_same(
    released: Path, build: Path, tmp_path: Path
) -> None:
    package = older(REPOSITORY / "modelica" / "Sigmahat", tmp_path / "Sigmahat")
    sources = [build / "amalgamation" / f"sigmahat.{suffix}" for suffix in "ch"]
    sources += [REPOSITORY / "fmu_src" / f"noise.{suffix}" for suffix in "ch"]
    again = tmp_path / "again.zip"
    descriptions, licence = REPOSITORY / "modelDescription", REPOSITORY / "LICENSE"
    modelica.write(again, package, descriptions, sources, licence, sigmahat.__version__)
    assert again.read_bytes() == (released / "sigmahat-modelica.zip").read_bytes()


@pytest.mark.slow("wheels are packed again")
def test_the_wheels_made_elsewhere_are_the_same(
    released: Path, build: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiled(
        _sources: object, _includes: object, stem: Path, platform: str, _cache: object
    ) -> Path:
        """The library of the released wheel, instead of one that is compiled again."""
        tag = distribution.TAGS[platform]
        wheel = next((released / "python").glob(f"*{tag}.whl"))
        with ZipFile(wheel) as opened:
            (name,) = (n for n in opened.namelist() if "/sigmahat_native." in n)
            library = stem.with_name(Path(name).name)
            library.write_bytes(opened.read(name))
        library.chmod(0o755)  # as a compiler writes it
        return library

    monkeypatch.setattr(distribution, "compile_shared", compiled)
    contents = [*(released / f"{name}.fmu" for name in FMUS), released / "sigmahat-awas.ssp"]
    distribution.write(tmp_path / "python", REPOSITORY, contents, [], [], tmp_path)
    for file in (released / "python").glob("*.whl"):
        assert (tmp_path / "python" / file.name).read_bytes() == file.read_bytes(), file.name
