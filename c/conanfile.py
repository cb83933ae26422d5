"""The C library as a package of Conan 2: ``conan create c``."""

import re
from pathlib import Path
from typing import Any, ClassVar

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load

SIZES = {"max_n": "SH_MAX_N", "max_m": "SH_MAX_M", "max_columns": "SH_MAX_COLUMNS"}
"""Option of the recipe, and the definition that it sets: sizes of an estimator, see sigmahat.h."""


class SigmahatConan(ConanFile):  # type: ignore[misc] # Conan has no types
    """Recipe. Without this option, the estimator has the largest size."""

    name = "sigmahat"
    description = "Stiffness of flexible robot joints, estimated on line"
    license = "BSD-2-Clause"
    package_type = "static-library"
    languages = "C"
    settings: Any = "os", "arch", "compiler", "build_type"
    options: ClassVar[Any] = {
        "real": ["double", "float"],
        **{size: [None, "ANY"] for size in SIZES},
    }
    default_options: ClassVar[Any] = {"real": "double", **dict.fromkeys(SIZES)}
    test_package_folder = "../examples/conan_package"

    def set_version(self) -> None:
        """The version is that of the project."""
        text = load(self, str(Path(self.recipe_folder).parent / "pyproject.toml"))
        self.version = re.findall(r'^version = "(.*)"$', text, re.MULTILINE)[0]

    def export_sources(self) -> None:
        """CMakeLists.txt reads the version from the folder above, so both folders are copied."""
        above = Path(self.recipe_folder).parent
        for name in ("LICENSE", "pyproject.toml"):
            copy(self, name, str(above), self.export_sources_folder)
        copy(self, "*", self.recipe_folder, str(Path(self.export_sources_folder) / "c"))

    def _sizes(self) -> dict[str, str]:
        """The options that are given, by name."""
        values = {size: str(self.options.get_safe(size)) for size in SIZES}
        return {size: value for size, value in values.items() if value != "None"}

    def validate(self) -> None:
        """A size is a whole number from 1 on."""
        for size, value in self._sizes().items():
            if not re.fullmatch(r"[1-9]\d*", value):
                raise ConanInvalidConfiguration(
                    f"{size}: expected a whole number from 1 on, received {value}"
                )

    def layout(self) -> None:
        """Folders as Conan's CMake has them."""
        cmake_layout(self)

    def _definitions(self) -> dict[str, str]:
        """Definitions for the library, and for every file that includes sigmahat.h."""
        sizes = {SIZES[size]: value for size, value in self._sizes().items()}
        return sizes | ({"SH_REAL": "float"} if self.options.real == "float" else {})

    def generate(self) -> None:
        """The options become variables of CMakeLists.txt."""
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update(self._definitions())
        toolchain.generate()

    def build(self) -> None:
        """Compiles the library."""
        cmake = CMake(self)
        cmake.configure(build_script_folder="c")
        cmake.build()

    def package(self) -> None:
        """Installs the library and its licence."""
        CMake(self).install()
        licences = str(Path(self.package_folder) / "licenses")
        copy(self, "LICENSE", self.source_folder, licences)

    def package_info(self) -> None:
        """The names are those of find_package and pkg-config without Conan."""
        self.cpp_info.libs = ["sigmahat"]
        self.cpp_info.defines = [f"{name}={value}" for name, value in self._definitions().items()]
        if self.settings.get_safe("os") != "Windows":
            self.cpp_info.system_libs = ["m"]
