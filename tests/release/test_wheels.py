"""The wheels and the source distribution of a release, read from the files."""

import json
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

import sigmahat
from controllers import run
from released_fmus import FMUS

EXTENSIONS = {"manylinux_2_17_x86_64": ".so", "win_amd64": ".dll", "macosx_11_0_x86_64": ".dylib"}
each_platform = pytest.mark.parametrize("tag", EXTENSIONS)


@pytest.fixture(scope="module")
def folder(released: Path) -> Path:
    return released / "python"


def wheel(folder: Path, tag: str) -> Path:
    return folder / f"sigmahat-{sigmahat.__version__}-py3-none-{tag}.whl"


def test_there_is_one_for_each_platform_and_the_sources(folder: Path) -> None:
    expected = {wheel(folder, tag).name for tag in EXTENSIONS}
    expected.add(f"sigmahat-{sigmahat.__version__}.tar.gz")
    assert {path.name for path in folder.iterdir()} == expected


@each_platform
def test_it_contains_the_released_fmus_and_its_library_alone(
    tag: str, folder: Path, released: Path
) -> None:
    with zipfile.ZipFile(wheel(folder, tag)) as archive:
        files = {
            Path(name).name: archive.read(name)
            for name in archive.namelist()
            if name.startswith("sigmahat/fmus/")
        }
        assert "sigmahat/py.typed" in archive.namelist()
        assert not any("__pycache__" in name for name in archive.namelist())
    native = {f"sigmahat_native{EXTENSIONS[tag]}"}
    assert files.keys() == {*(f"{name}.fmu" for name in FMUS), "sigmahat-awas.ssp", *native}
    for name in files.keys() - native:
        assert files[name] == (released / name).read_bytes()


@each_platform
def test_its_record_is_right(tag: str, folder: Path, tmp_path: Path) -> None:
    """`wheel unpack` compares every file with its hash."""
    run(sys.executable, "-m", "wheel", "unpack", "-d", tmp_path, wheel(folder, tag))
    (kind,) = tmp_path.glob("*/*.dist-info/WHEEL")
    text = kind.read_text()
    assert f"Tag: py3-none-{tag}\n" in text and "Root-Is-Purelib: false\n" in text


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the wheel of this machine")
def test_from_the_wheel_of_linux_the_estimator_gives_the_same_bits(
    folder: Path, tmp_path: Path
) -> None:
    with zipfile.ZipFile(wheel(folder, "manylinux_2_17_x86_64")) as archive:
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
    # Without "site" the package of this tree is on no path.
    for command in (["-S", "-c", program, tmp_path, packages], ["-c", program]):
        found.append(json.loads(run(sys.executable, *command)))
    assert Path(found[0][0]).is_relative_to(tmp_path)
    assert not Path(found[1][0]).is_relative_to(tmp_path)
    assert found[0][1:] == found[1][1:]
    assert len(set(found[0][2])) > 100
