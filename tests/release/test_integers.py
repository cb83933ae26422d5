"""The estimators without enumerations: the same FMUs, for importers that cannot set these."""

from pathlib import Path
from typing import Any
from zipfile import ZipFile

import fmpy
import pytest

import sigmahat
from fmi_instance import OK, Instance, Instance3
from fmi_runs import ESTIMATORS, SIGNALS, names
from sigmahat_build import integers

VERSIONS = ["", "_FMI3"]
DESCRIPTION = "modelDescription.xml"


def built(build: Path, name: str, version: str) -> Path:
    """The FMU of this machine."""
    return build / "fmi3" / f"{name}_FMI3.fmu" if version else sigmahat.fmu(name)


@pytest.mark.parametrize("name", ESTIMATORS)
@pytest.mark.parametrize("version", VERSIONS)
def test_each_enumeration_is_an_integer_with_the_same_numbers(
    name: str, version: str, build: Path, tmp_path: Path
) -> None:
    source, copy = built(build, name, version), tmp_path / "copy.fmu"
    integers.write(source, copy)
    old: Any = fmpy.read_model_description(str(source))
    new: Any = fmpy.read_model_description(str(copy), validate=True)
    assert (old.guid, len(old.modelVariables)) == (new.guid, len(new.modelVariables))
    changed = 0
    for before, after in zip(old.modelVariables, new.modelVariables, strict=True):
        keys = ["name", "valueReference", "causality", "variability", "start", "unit"]
        assert [getattr(before, k) for k in keys] == [getattr(after, k) for k in keys]
        if before.type != "Enumeration":
            assert (before.type, before.description) == (after.type, after.description)
            continue
        changed += 1
        items = before.declaredType.items
        assert after.type == ("Int64" if version else "Integer") and after.declaredType is None
        assert [after.min, after.max] == [items[0].value, items[-1].value]
        assert after.description.startswith(before.description)
        for item in items:
            assert f"{item.value} {item.name}" in after.description
    assert changed > 6


class _Instance3(Instance3):
    types = {  # noqa: RUF012
        **Instance3.types,
        "Int64": Instance3.types["Enumeration"],
    }


@pytest.mark.parametrize("version", VERSIONS)
def test_it_takes_the_numbers_and_gives_the_same_results(
    version: str, build: Path, tmp_path: Path
) -> None:
    source, copy = built(build, "StiffnessEstimator", version), tmp_path / "copy.fmu"
    integers.write(source, copy)
    results = []
    for path in (source, copy):
        with (_Instance3 if version else Instance)(path) as fmu:
            fmu.initialise({"method": 2, "modality": 2, "filter.kind": 3})
            for k in range(100):
                fmu.set_all({n: SIGNALS[n](k * 1e-3) for n in names(fmu, "input")})
                assert fmu.step(k * 1e-3, 1e-3) == OK
            results.append(fmu.get_all(names(fmu, "output")))
    assert results[0] == results[1]
    assert results[0] != [0.0] * len(results[0])


@pytest.mark.parametrize("name", ESTIMATORS)
@pytest.mark.parametrize("version", VERSIONS)
def test_the_release_has_it_with_the_same_binaries(name: str, version: str, released: Path) -> None:
    with (
        ZipFile(released / f"{name}{version}.fmu") as source,
        ZipFile(released / f"{name}{version}_Integers.fmu") as copy,
    ):
        assert source.namelist() == copy.namelist()
        differ = [n for n in source.namelist() if source.read(n) != copy.read(n)]
        assert differ == [DESCRIPTION]
        assert b"Enumeration" not in copy.read(DESCRIPTION)
