"""Mutation testing of the C library: do its tests detect one wrong token?

    build/venv/bin/python tests/helpers/mutation.py [NUMBER [SEED]]

The program selects NUMBER places in all files of c/. At each place the program changes one token,
such as an operator or a constant, and runs the tests with this mutant. The program prints all
mutants that pass the tests. A hash of SEED and of the source line selects a place, so that changes
of other lines do not affect the selection.
"""

import hashlib
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
LIBRARY = TESTS.parent / "c"
FILE = "libsigmahat_test_driver.so"
SOURCES = {file.name: file for file in sorted(LIBRARY.rglob("*.c"))}
NUMBER, SEED = 6, "fresh-b"  # the sample that CI tests
LIMIT = 400
"""Processor time [s] after which a mutant counts as an endless loop; tests are much faster."""
REQUIRED = 0.9  # share of the mutants that the tests must detect
TESTED = (*(Path(name).stem for name in SOURCES), "regression_oracle", "misfit_columns", "evaluate")
"""Names of the tests that use the C library of the build tree."""
PYTEST = ("-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", "-m", "not slow")
FLAGS = (
    *("-std=gnu99", "-O1", "-ffp-contract=off", "-fPIC", "-w", "-fsanitize=bounds"),
    "-fsanitize-undefined-trap-on-error",
    *sorted({f"-I{header.parent}" for header in LIBRARY.rglob("*.h")}),
)

# Replacements of a token. The first replacement that changes the compiled program is used.
SWAPS = {
    "<": ("<=", ">"), "<=": ("<", ">="), ">": (">=", "<"), ">=": (">", "<="),
    "==": ("!=",), "!=": ("==",), "&&": ("||",), "||": ("&&",),
    "+": ("-",), "-": ("+",), "*": ("/", "+"), "/": ("*",),
    "+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",), "++": ("--",),
    "i": ("j",), "j": ("i", "k"), "k": ("j",),
    "sh_fmin": ("sh_fmax",), "sh_fmax": ("sh_fmin",), "sh_fabs": ("-",), "sh_sqrt": ("sh_fabs",),
    "sh_exp": ("cos",), "sh_log": ("cos",), "sh_sin": ("cos",), "sh_cos": ("sin",), "!": ("",),
    "break": ("continue",), "continue": ("break",),
}  # fmt: skip
TOKEN = re.compile(
    r"(?P<skip>/\*.*?\*/|^\s*#.*?$|\"[^\"\n]*\")|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<number>\d+\.?\d*(?:e[-+]?\d+)?)|(?P<operator>[-+*/<>=!&|]{1,2})",
    re.DOTALL | re.MULTILINE,
)

# Equivalent mutants: file, changed code, and the reason why no test can detect the change.
EQUIVALENT: tuple[tuple[str, str, str], ...] = (
    ("columns.c", "return -(gamma) * f->first", "no output has the sign of this column"),
    ("method.c", "return p->method >= 1 &&", "there is no method 0; in the table it is NULL"),
    ("motion_sign.c", "way = change >= 0 ? 1 : -1;", "it is not used if the change is zero"),
    ("state_variable_filter.c", "sh_fabs(behind[2][i]) <= SMALL", "it is never exactly 1e-30"),
)


@dataclass(frozen=True)
class Mutant:
    """A C source file in which one token is changed."""

    file: str
    start: int
    old: str
    new: str

    def text(self) -> str:
        original = SOURCES[self.file].read_text()
        return original[: self.start] + self.new + original[self.start + len(self.old) :]

    def line(self) -> str:
        """Returns the source line after the change."""
        text = self.text()
        begin = text.rfind("\n", 0, self.start) + 1
        return text[begin : text.find("\n", self.start)].strip()

    def makes(self, code: str) -> bool:
        """Returns whether the mutant contains `code`, which may have several lines."""
        texts = (" ".join(text.split()) for text in (SOURCES[self.file].read_text(), self.text()))
        before, after = (text.count(code) for text in texts)
        return after > before

    def __str__(self) -> str:
        return f"{self.file}: {self.old!r} -> {self.new!r}: {self.line()}"


def wrong(kind: str | None, token: str) -> tuple[str, ...]:
    if kind == "number":
        real = "." in token or "e" in token
        return (str(1.5 * float(token) + 1.0) if real else str(int(token) + 1),)
    return SWAPS.get(token, ())


def candidates(file: Path, seed: str) -> list[tuple[Mutant, ...]]:
    """Returns the possible mutants of each place in a file, with the places in random order."""
    places = []
    alike: Counter[str] = Counter()
    for match in TOKEN.finditer(file.read_text()):
        if news := wrong(match.lastgroup, match.group()):
            mutants = tuple(Mutant(file.name, match.start(), match.group(), new) for new in news)
            line = mutants[0].line()
            alike[line] += 1
            key = hashlib.sha256(f"{seed} {file.name} {line} {alike[line]}".encode()).hexdigest()
            places.append((key, mutants))
    return [mutants for _, mutants in sorted(places, key=lambda place: place[0])]


def build(folder: Path, mutant: Mutant | None = None) -> Path | None:
    """Builds the library or a mutant in a new folder. Returns None if the code does not compile."""
    tree = Path(tempfile.mkdtemp(dir=folder))
    sources = {**SOURCES, "run.c": TESTS / "drivers" / "run.c"}
    if mutant:
        sources[mutant.file] = tree / mutant.file
        sources[mutant.file].write_text(mutant.text())
    command = ["gcc", *FLAGS, "-shared", *map(str, sources.values()), "-lm", "-o", str(tree / FILE)]
    done = subprocess.run(command, capture_output=True)
    return tree if done.returncode == 0 else None


def files_for(source: str = "") -> list[str]:
    """Returns all test files, beginning with the tests of the changed source and of all parts."""
    files = [*sorted(TESTS.glob("c/parts/test_*.py"))]
    files += [path for name in TESTED for path in TESTS.glob(f"c/test_{name}.py")]
    own = f"test_{Path(source).stem}"
    return [str(path) for path in sorted(files, key=lambda path: path.stem != own)]


def passes(tree: Path, files: Sequence[str]) -> bool:
    """Runs the fast tests with the library in a build tree, and then removes the tree. Returns
    False if a test fails or crashes, or if the tests take longer than LIMIT."""
    command = [sys.executable, "-m", "pytest", *PYTEST, *files]
    environment = {**os.environ, "SIGMAHAT_BUILD": str(tree)}
    pipe, both = subprocess.PIPE, subprocess.STDOUT
    with subprocess.Popen(command, env=environment, stdout=pipe, stderr=both, text=True) as process:
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (LIMIT, LIMIT))
        text = process.communicate()[0]
    if process.returncode > 1:
        raise RuntimeError(f"pytest ended with {process.returncode}:\n{text}")
    shutil.rmtree(tree)
    return process.returncode == 0


def shares(number: int) -> dict[str, int]:
    """Number of mutants of each file: proportional to its number of places, but at least two."""
    places = {name: len(candidates(file, "")) for name, file in SOURCES.items()}
    total = sum(places.values())
    return {file: max(2, round(number * count / total)) for file, count in places.items()}


def mutants(folder: Path, file: str, number: int, seed: str) -> Iterator[tuple[Mutant, Path]]:
    """Yields mutants of a file that compile to a different program, with their build trees."""
    unchanged = (folder / FILE).read_bytes()
    for choices in candidates(SOURCES[file], seed):
        if number == 0:
            return
        for mutant in choices:
            tree = build(folder, mutant)
            if tree and (tree / FILE).read_bytes() != unchanged:
                yield mutant, tree
                number -= 1
                break


def judge(folder: Path, file: str, number: int, seed: str) -> Counter[str]:
    """Tests mutants of a file; returns how many are killed, survive, or are equivalent."""
    outcome: Counter[str] = Counter()
    for mutant, tree in mutants(folder, file, number, seed):
        passed = passes(tree, files_for(file))
        same = any(file == where and mutant.makes(code) for where, code, _ in EQUIVALENT)
        result = "killed" if not passed else "equivalent" if same else "survived"
        outcome[result] += 1
        if passed:
            print(f"{result}: {mutant}", flush=True)
    return outcome


def run(folder: Path, number: int, seed: str) -> Counter[str]:
    """Makes at least `number` mutants in a temporary folder and runs the tests with each.

    Returns how many mutants were killed, survived, or are equivalent. Raises RuntimeError if the
    tests fail with the unchanged code.
    """
    unchanged = build(folder)
    if unchanged is None:
        raise RuntimeError("the library does not compile")
    shutil.copy(unchanged / FILE, folder)
    if not passes(unchanged, files_for()):
        raise RuntimeError("the tests fail without any change")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [pool.submit(judge, folder, *part, seed) for part in shares(number).items()]
        return sum((job.result() for job in jobs), Counter())


def main() -> int:
    number, seed = (*sys.argv[1:], *(str(NUMBER), SEED)[len(sys.argv) - 1 :])
    with tempfile.TemporaryDirectory() as folder:
        outcome = run(Path(folder), int(number), seed)
    share = outcome["killed"] / (outcome["killed"] + outcome["survived"])
    counts = ", ".join(f"{name} {outcome[name]}" for name in ("killed", "survived", "equivalent"))
    print(f"{counts}: {100 * share:.1f} % killed")
    return int(share < REQUIRED)


if __name__ == "__main__":
    sys.exit(main())
