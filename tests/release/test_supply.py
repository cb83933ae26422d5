"""Wheels and bill of materials of the release. Archives do not depend on the build folder."""

import hashlib
import json
import os
import shutil
import sys
import sysconfig
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

import sigmahat
from controllers import run
from released_fmus import FMUS
from sigmahat_build import bill, distribution, modelica

REPOSITORY = Path(__file__).parents[2]
OLD = 86400.0  # [s] since 1970
EXTENSIONS = {"manylinux_2_17_x86_64": ".so", "win_amd64": ".dll", "macosx_11_0_x86_64": ".dylib"}
each_platform = pytest.mark.parametrize("tag", EXTENSIONS)


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
    packages = {each["name"] for each in contents["components"] if each["bom-ref"] in inside[wheel]}
    assert {"numpy", "fmpy", "pyarrow"} <= packages
    assert "ziglang" in {each["name"] for each in contents["metadata"]["tools"]["components"]}


def older(folder: Path, copy: Path) -> Path:
    """Copies a folder and gives all files an older time of modification."""
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
        """Returns the library from the released wheel instead of compiling the library again."""
        tag = distribution.TAGS[platform]
        wheel = next((released / "python").glob(f"*{tag}.whl"))
        with ZipFile(wheel) as opened:
            (name,) = (n for n in opened.namelist() if "/sigmahat_native." in n)
            library = stem.with_name(Path(name).name)
            library.write_bytes(opened.read(name))
        library.chmod(0o755)  # like a compiled library
        return library

    monkeypatch.setattr(distribution, "compile_shared", compiled)
    contents = [*(released / f"{name}.fmu" for name in FMUS), released / "sigmahat-awas.ssp"]
    distribution.write(tmp_path / "python", REPOSITORY, contents, [], [], tmp_path)
    for file in (released / "python").glob("*.whl"):
        assert (tmp_path / "python" / file.name).read_bytes() == file.read_bytes(), file.name


# Contents of the wheels and of the source distribution


def wheel(released: Path, tag: str) -> Path:
    return released / "python" / f"sigmahat-{sigmahat.__version__}-py3-none-{tag}.whl"


def test_there_is_a_wheel_for_each_platform_and_the_sources(released: Path) -> None:
    expected = {wheel(released, tag).name for tag in EXTENSIONS}
    expected.add(f"sigmahat-{sigmahat.__version__}.tar.gz")
    assert {path.name for path in (released / "python").iterdir()} == expected


@each_platform
def test_a_wheel_contains_the_released_fmus_and_its_library(tag: str, released: Path) -> None:
    with ZipFile(wheel(released, tag)) as archive:
        files = {
            Path(name).name: archive.read(name)
            for name in archive.namelist()
            if name.startswith("sigmahat/fmus/")
        }
        assert "sigmahat/py.typed" in archive.namelist()
        assert not any("__pycache__" in name for name in archive.namelist())
        assert all(name.startswith(("sigmahat/", "sigmahat-")) for name in archive.namelist())
    native = {f"sigmahat_native{EXTENSIONS[tag]}"}
    assert files.keys() == {*(f"{name}.fmu" for name in FMUS), "sigmahat-awas.ssp", *native}
    for name in files.keys() - native:
        assert files[name] == (released / name).read_bytes()


@each_platform
def test_the_record_of_a_wheel_is_right(tag: str, released: Path, tmp_path: Path) -> None:
    """The command `wheel unpack` compares the hash of every file."""
    run(sys.executable, "-m", "wheel", "unpack", "-d", tmp_path, wheel(released, tag))
    (kind,) = tmp_path.glob("*/*.dist-info/WHEEL")
    text = kind.read_text()
    assert f"Tag: py3-none-{tag}\n" in text and "Root-Is-Purelib: false\n" in text


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the wheel of this machine")
def test_from_the_wheel_of_linux_the_estimator_gives_the_same_bits(
    released: Path, tmp_path: Path
) -> None:
    with ZipFile(wheel(released, "manylinux_2_17_x86_64")) as archive:
        archive.extractall(tmp_path)
    program = """
import json, math, sys
sys.path += sys.argv[1:]
import sigmahat
run = sigmahat.run(sigmahat.scenario("single-linear"), seed=1)
theta = [math.sin(0.01 * k) for k in range(2000)]
estimator = sigmahat.Estimator({"method": "FilteredRegression", "range.phi": 0.002})
sigma = estimator.run(theta, [1.002 * x for x in theta], [-0.04 * x for x in theta])["sigma"]
print(json.dumps([sigmahat.__file__, run.estimators["RESIDUAL"]["sigma"].tolist(), sigma.tolist()]))
"""
    found = []
    packages = sysconfig.get_path("purelib")
    # The option -S disables the module site, so that no path leads to the package of this tree.
    for command in (["-S", "-c", program, tmp_path, packages], ["-c", program]):
        found.append(json.loads(run(sys.executable, *command)))
    assert Path(found[0][0]).is_relative_to(tmp_path)
    assert not Path(found[1][0]).is_relative_to(tmp_path)
    assert found[0][1:] == found[1][1:]
    assert len(set(found[0][2])) > 100
