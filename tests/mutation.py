"""Mutation testing of c/: would the tests notice one wrong token?

    build/venv/bin/python tests/mutation.py [NUMBER [SEED]]

changes one token (operator, comparison, constant, index, function) at NUMBER places, spread over
all files of c/, one at a time, and runs the tests of the library against each. It prints those
that no test noticed. Places are chosen by a hash of SEED and their line, so they stay the same
when the code changes elsewhere.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parent
LIBRARY = TESTS.parent / "c"
NUMBER, SEED = 66, "1"  # of the sample in the gate
CPU_SECONDS = 120  # of the tests of one mutant; one that runs longer hangs
ASKED = 0.9  # share that tests have to notice
FLAGS = (
    "-std=gnu99",
    "-O1",
    "-ffp-contract=off",
    "-fPIC",
    "-w",
    "-fsanitize=bounds",
    "-fsanitize-undefined-trap-on-error",
    f"-I{LIBRARY}",
)

# What is wrong with a token instead: the first that compiles to something else.
SWAPS = {
    "<": ("<=", ">"), "<=": ("<", ">="), ">": (">=", "<"), ">=": (">", "<="),
    "==": ("!=",), "!=": ("==",), "&&": ("||",), "||": ("&&",),
    "+": ("-",), "-": ("+",), "*": ("/", "+"), "/": ("*",),
    "+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",), "++": ("--",),
    "i": ("j",), "j": ("i", "k"), "k": ("j",),
    "sh_fmin": ("sh_fmax",), "sh_fmax": ("sh_fmin",), "sh_fabs": ("-",), "sh_sqrt": ("sh_fabs",),
    "sh_exp": ("cos",), "sh_sin": ("cos",), "!": ("",),
    "break": ("continue",), "continue": ("break",),
}  # fmt: skip
TOKEN = re.compile(
    r"(?P<skip>/\*.*?\*/|^\s*#.*?$|\"[^\"\n]*\")|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<number>\d+\.?\d*(?:e[-+]?\d+)?)|(?P<operator>[-+*/<>=!&|]{1,2})",
    re.DOTALL | re.MULTILINE,
)

# Mutants that no test can notice: file, changed line, why it makes no difference.
EQUIVALENT: tuple[tuple[str, str, str], ...] = (
    (
        "least_squares.c",
        "epsilon -= F[j] * rls->eta[j] + F[i] * rls->eta_low[j];",
        "eta_low is less than the last digit of eta, and so is their sum's part of it",
    ),
    (
        "matched_regression.c",
        "if (settings->drift >= 0.0)",
        "without drift the covariance is widened by zero and is not above the prior",
    ),
    (
        "matched_regression.c",
        "if (matched->samples < 3)",
        "is compared with 0 and 1 alone",
    ),
)


@dataclass(frozen=True)
class Mutant:
    """One file of c/ with one token changed."""

    file: str
    start: int
    old: str
    new: str

    def text(self) -> str:
        original = (LIBRARY / self.file).read_text()
        return original[: self.start] + self.new + original[self.start + len(self.old) :]

    def line(self) -> str:
        """The changed line as it now reads."""
        text = self.text()
        begin = text.rfind("\n", 0, self.start) + 1
        return text[begin : text.find("\n", self.start)].strip()

    def order(self, seed: str) -> str:
        return hashlib.sha256(f"{seed} {self.file} {self.line()}".encode()).hexdigest()

    def __str__(self) -> str:
        return f"{self.file}: {self.old!r} -> {self.new!r}: {self.line()}"


def wrong(kind: str | None, token: str) -> tuple[str, ...]:
    if kind == "number":
        real = "." in token or "e" in token
        return (str(1.5 * float(token) + 1.0) if real else str(int(token) + 1),)
    return SWAPS.get(token, ())


def candidates(file: Path, seed: str) -> list[tuple[Mutant, ...]]:
    """The places of a file, in the order in which they are taken: mutants to try at each."""
    places = []
    for match in TOKEN.finditer(file.read_text()):
        if news := wrong(match.lastgroup, match.group()):
            places.append(
                tuple(Mutant(file.name, match.start(), match.group(), new) for new in news)
            )
    return sorted(places, key=lambda mutants: mutants[0].order(seed))


class Bench:
    """Compiles mutants beside the objects of the other files, and runs tests against them."""

    def __init__(self, folder: Path, compiler: str = "gcc") -> None:
        self.folder, self.compiler = folder, compiler
        run = TESTS / "drivers" / "run.c"
        self.objects: dict[str, Path] = {}
        for file in (*sorted(LIBRARY.glob("*.c")), run):
            self.objects[file.name] = folder / f"{file.stem}.o"
            if not self.compile(file, self.objects[file.name]):
                raise RuntimeError(f"{file} does not compile")

    def compile(self, source: Path, target: Path) -> bool:
        command = [self.compiler, *FLAGS, "-c", str(source), "-o", str(target)]
        return subprocess.run(command, capture_output=True).returncode == 0

    def link(self, tree: Path, objects: Mapping[str, Path]) -> Path:
        library = tree / "libsigmahat_test_driver.so"
        command = [self.compiler, "-shared", *map(str, objects.values()), "-lm", "-o", str(library)]
        subprocess.run(command, check=True)
        return tree

    def build(self, mutant: Mutant) -> Path | None:
        """A build tree with the mutant's library, None if it is no C or the same program."""
        tree = Path(tempfile.mkdtemp(dir=self.folder))
        source = tree / mutant.file
        source.write_text(mutant.text())
        changed = tree / "mutant.o"
        original = self.objects[mutant.file].read_bytes()
        if not self.compile(source, changed) or changed.read_bytes() == original:
            shutil.rmtree(tree)
            return None
        return self.link(tree, {**self.objects, mutant.file: changed})

    def killed(self, mutant: Mutant, tree: Path) -> bool:
        """Whether a test fails with the mutant, or crashes, or hangs. Removes the tree."""
        killed = not passes(tree, mutant.file)
        shutil.rmtree(tree)
        return killed


def passes(tree: Path, file: str = "") -> bool:
    """Whether the fast tests pass with the library of a build tree, those of a file first."""
    own = f"test_c_{Path(file).stem}.py"
    files = sorted(TESTS.glob("test_c_*.py"), key=lambda path: (path.name != own, path))
    pytest = [
        *(sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"),
        *("--hypothesis-seed=0", "-m", "not slow"),
        *map(str, files),
    ]
    done = subprocess.run(
        ["sh", "-c", 'ulimit -t "$0"; exec "$@"', str(CPU_SECONDS), *pytest],
        cwd=tree,
        env={**os.environ, "SIGMAHAT_BUILD": str(tree)},
        capture_output=True,
        text=True,
    )
    if done.returncode > 1:
        raise RuntimeError(f"pytest ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.returncode == 0


def shares(number: int) -> dict[str, int]:
    """How many mutants each file gets: at least three, else by its number of places."""
    places = {file.name: len(candidates(file, "")) for file in sorted(LIBRARY.glob("*.c"))}
    total = sum(places.values())
    return {file: max(3, round(number * count / total)) for file, count in places.items()}


def mutants(bench: Bench, file: str, number: int, seed: str) -> Iterator[tuple[Mutant, Path]]:
    """The first mutants of a file that are programs of their own, with their build trees."""
    for choices in candidates(LIBRARY / file, seed):
        if number == 0:
            return
        for mutant in choices:
            if tree := bench.build(mutant):
                yield mutant, tree
                number -= 1
                break


@dataclass(frozen=True)
class Outcome:
    """What became of the mutants."""

    killed: list[Mutant]
    equivalent: list[Mutant]
    survived: list[Mutant]

    def share(self) -> float:
        """Killed ones among those that a test could notice."""
        return len(self.killed) / (len(self.killed) + len(self.survived))


def run(folder: Path, number: int = NUMBER, seed: str = SEED) -> Outcome:
    """Makes at least `number` mutants in a scratch folder and runs the tests against each.

    Raises RuntimeError if the tests do not pass with the code as it is.
    """
    bench = Bench(folder)
    unchanged = Path(tempfile.mkdtemp(dir=folder))
    if not passes(bench.link(unchanged, bench.objects)):
        raise RuntimeError("the tests fail without any change")
    known = {(file, line) for file, line, _ in EQUIVALENT}
    outcome = Outcome([], [], [])
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = [
            pair for file, n in shares(number).items() for pair in mutants(bench, file, n, seed)
        ]
        for (mutant, _), killed in zip(
            made, pool.map(lambda pair: bench.killed(*pair), made), strict=True
        ):
            if killed:
                outcome.killed.append(mutant)
            elif (mutant.file, mutant.line()) in known:
                outcome.equivalent.append(mutant)
            else:
                outcome.survived.append(mutant)
                print(f"survived: {mutant}", flush=True)
    return outcome


def main() -> int:
    number, seed = (*sys.argv[1:], *(str(NUMBER), SEED)[len(sys.argv) - 1 :])
    with tempfile.TemporaryDirectory() as folder:
        outcome = run(Path(folder), int(number), seed)
    for mutant in outcome.equivalent:
        print(f"equivalent: {mutant}")
    print(
        f"killed {len(outcome.killed)}, survived {len(outcome.survived)}, "
        f"equivalent {len(outcome.equivalent)}: {100.0 * outcome.share():.1f} % killed"
    )
    return int(outcome.share() < ASKED)


if __name__ == "__main__":
    sys.exit(main())
