"""The programs of `drivers/`, each linked with the sources of one FMU.

If a compiler or a checker is missing, the test is skipped. In the gate, which sets SIGMAHAT_GATE=1,
the test fails instead.
"""

import shutil
import subprocess
import tempfile
from pathlib import Path

from c_sources import FOLDERS, REPOSITORY, SOURCES
from fmi_functions import HEADERS
from fmi_runs import ESTIMATORS
from gate import missing

FMU_SOURCES = REPOSITORY / "fmu_src"
PLANT_SOURCES = ("plant.c", "radau.c", "noise.c")
DRIVERS = REPOSITORY / "tests" / "drivers"


def sources(fmu: str, build: Path, version: str) -> list[Path]:
    """The C source files of an FMU, with the functions of a version of FMI."""
    files = sorted([*(FMU_SOURCES / "shell").glob("*.c"), *(FMU_SOURCES / version).glob("*.c")])
    if fmu in ESTIMATORS:
        own = [FMU_SOURCES / name for name in (f"{fmu}.c", "estimator_fmu.c")]
        return files + own + SOURCES
    return [
        *files,
        *(FMU_SOURCES / name for name in PLANT_SOURCES),
        build / f"fmu/{fmu}/plant_functions.c",
    ]


def compile_driver(
    driver: str,
    fmu: str,
    version: str,
    build: Path,
    folder: Path,
    compiler: str,
    flags: tuple[str, ...],
) -> Path:
    """Compiles a program of drivers/ and an FMU, in a new folder inside `folder`.

    driver   "instances", "instructions" or "fuzz"
    version  of FMI, "fmi2" or "fmi3"
    """
    program = Path(tempfile.mkdtemp(dir=folder)) / f"{driver}_{version}_{fmu}"
    folders = [*FOLDERS, FMU_SOURCES, FMU_SOURCES / "shell", build / "fmu" / fmu]
    files = [DRIVERS / f"{driver}.c", *sources(fmu, build, version)]
    command = [
        # -gdwarf-4: valgrind cannot read newer debug information
        *(compiler, "-gdwarf-4", "-O1", "-ffp-contract=off", *flags, f"-DSH_FMI={version[-1]}"),
        *(f"-I{path}" for path in folders),
        *(f"-isystem{HEADERS}", *map(str, files), "-lm", "-o", str(program)),
    ]
    # The compilation has no time limit, because a compiler may first build its C library for
    # minutes.
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return program


def compiler_with(flags: tuple[str, ...], folder: Path) -> str:
    """A compiler that can build programs with these flags that run; a runtime may be missing."""
    entry = "LLVMFuzzerTestOneInput" if any("fuzzer" in flag for flag in flags) else "main"
    source, program = folder / "probe.c", str(folder / "probe")
    source.write_text(f"int {entry}(void) {{ return 0; }}\n")
    for compiler in filter(shutil.which, ("clang", "gcc")):
        commands = [[compiler, *flags, str(source), "-o", program], [program, "-runs=1"]]
        if not any(subprocess.run(each, capture_output=True).returncode for each in commands):
            return compiler
    missing(f"a compiler for {' '.join(flags)}", "apt-get install clang libclang-rt-dev")
