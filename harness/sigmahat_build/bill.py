"""Writes the bill of materials of a release in CycloneDX: components of each file, and build tools.

The bill depends only on the files of the release, so that the same release gives the same bytes.
The bill has no time, and the serial number is computed from the files.
"""

import hashlib
import re
from collections.abc import Iterable
from importlib.metadata import distributions
from importlib.metadata import version as installed_version
from pathlib import Path
from uuid import NAMESPACE_URL, uuid5
from zipfile import ZipFile

from cyclonedx.model import HashAlgorithm, HashType, Property
from cyclonedx.model.bom import Bom, BomMetaData
from cyclonedx.model.component import Component, ComponentScope, ComponentType
from cyclonedx.model.license import DisjunctiveLicense
from cyclonedx.model.tool import ToolRepository
from cyclonedx.output import make_outputter
from cyclonedx.schema import OutputFormat, SchemaVersion
from packageurl import PackageURL

from sigmahat.files.output import sha256

NAME = "sigmahat.cdx.json"
_BUILD_TOOLS = ("ziglang", "scikit-build-core", "wheel", "casadi", "cyclonedx-python-lib")
_ARCHIVES = (".fmu", ".ssp", ".zip", ".whl", ".gz")
_BSD_2 = "BSD-2-Clause"


def write(out: Path, release: Path, version: str) -> None:
    """Writes the bill of all files in the folder of a release.

    Raises FileNotFoundError if the folder has no wheel.
    """
    files = sorted(path for path in release.rglob("*") if path.suffix in _ARCHIVES)
    product = _component("sigmahat", version, ComponentType.FRAMEWORK, _BSD_2, "pkg:pypi/sigmahat")
    bom = Bom(metadata=BomMetaData(component=product))
    bom.metadata.tools = ToolRepository(components=map(_tool, _BUILD_TOOLS))
    headers = _component("FMI headers", None, ComponentType.LIBRARY, _BSD_2)
    source = Property(name="sigmahat:from", value=f"fmpy {installed_version('fmpy')}")
    headers.properties.add(source)
    c_sources = _component("C sources of sigmahat", version, ComponentType.LIBRARY, _BSD_2)
    casadi = "equations that CasADi wrote as C"
    equations = _component(casadi, version, ComponentType.LIBRARY, _BSD_2)
    packages = list(_packages(files))
    for component in (headers, c_sources, equations, *packages):
        bom.components.add(component)
    for file in files:
        name = file.relative_to(release).as_posix()
        entry = _component(name, None, ComponentType.FILE, None)
        entry.hashes.add(HashType(alg=HashAlgorithm.SHA_256, content=sha256(file)))
        bom.components.add(entry)
        bom.register_dependency(product, [entry])
        bom.register_dependency(entry, _contents(file, c_sources, headers, equations, packages))
    digest = hashlib.sha256("".join(map(sha256, files)).encode()).hexdigest()
    bom.serial_number = uuid5(NAMESPACE_URL, f"sigmahat {version} {digest}")
    bom.metadata.timestamp = None  # type: ignore[assignment] # the schema does not ask for one
    text = make_outputter(bom, OutputFormat.JSON, SchemaVersion.V1_6).output_as_string(indent=1)
    out.write_text(text + "\n", encoding="utf-8")


def _component(
    name: str, version: str | None, kind: ComponentType, licence: str | None, purl: str = ""
) -> Component:
    return Component(
        name=name,
        version=version,
        type=kind,
        bom_ref=name,
        licenses=[DisjunctiveLicense(id=licence)] if licence else [],
        purl=PackageURL.from_string(f"{purl}@{version}") if purl else None,
    )


def _tool(name: str) -> Component:
    version = installed_version(name)
    tool = _component(name, version, ComponentType.APPLICATION, None, f"pkg:pypi/{name}")
    tool.bom_ref.value = f"tool {name}"
    return tool


def _packages(files: Iterable[Path]) -> Iterable[Component]:
    """Lists packages that pip installs with a wheel, without extras; pip chooses the versions."""
    wheel = next((file for file in files if file.suffix == ".whl"), None)
    if wheel is None:
        raise FileNotFoundError("no wheel in the release; build it before the bill of materials")
    (packed,) = distributions(path=[str(wheel)])
    for requirement in packed.requires or ():
        package = re.split(r"[^\w.-]", requirement)[0]
        yield Component(
            name=package,
            type=ComponentType.LIBRARY,
            bom_ref=requirement,
            scope=ComponentScope.OPTIONAL if "extra ==" in requirement else ComponentScope.REQUIRED,
            purl=PackageURL("pypi", name=package.lower()),
            properties=[Property(name="sigmahat:requirement", value=requirement)],
        )


def _contents(
    file: Path,
    c_sources: Component,
    headers: Component,
    equations: Component,
    packages: list[Component],
) -> list[Component]:
    """Lists the components in a file of the release, and the packages that a wheel requires."""
    if file.suffix == ".zip":
        return [c_sources]
    if file.suffix == ".fmu":
        with ZipFile(file) as archive:
            is_plant = any(name.endswith("/plant_functions.c") for name in archive.namelist())
        return [c_sources, headers, *([equations] if is_plant else [])]
    of_python = packages if file.suffix in (".whl", ".gz") else []
    return [c_sources, *([] if file.suffix == ".gz" else [headers, equations]), *of_python]
