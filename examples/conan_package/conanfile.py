"""A program that uses the package of the C library; ``conan create c`` runs it."""

from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout


class Consumer(ConanFile):  # type: ignore[misc] # Conan has no types
    """Builds and runs the program."""

    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeDeps"
    languages = "C"

    def requirements(self) -> None:
        """The package as it was just made."""
        self.requires(self.tested_reference_str)

    def layout(self) -> None:
        """Folders as Conan's CMake has them."""
        cmake_layout(self)

    def generate(self) -> None:
        """Writes nothing beside the sources."""
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False
        toolchain.generate()

    def build(self) -> None:
        """Compiles the program."""
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def test(self) -> None:
        """Runs it where it can be run."""
        if can_run(self):
            program = Path(self.build_folder) / self.cpp.build.bindir / "consumer"
            self.run(f'"{program}"', env="conanrun")
