"""A report is one HTML file that shows results in a browser without a network."""

import csv
import html
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from selenium.webdriver.common.by import By

from browser import DATA, ROWS, Page, opened
from command_line import Shell, working_in
from recorded_logs import CONFIGURATION, awas_log, read_estimate, write_log
from sigmahat.result.log_panels import reduce

PICTURE = """
const view = [...Object.values(Bokeh.index.roots ?? Bokeh.index)][arguments[0]];
const {canvas, ctx} = view.canvas_view.primary;
const picture = ctx.getImageData(0, 0, canvas.width, canvas.height).data;
"""
CHANGED = f"""{PICTURE}
const before = window.before ?? [];
window.before = picture;
return before.length === picture.length && picture.some((x, i) => x !== before[i]);
"""
"""Script that returns true if the image of a plot has changed since its last call."""
SHOW = """
const [plot, shown, done] = arguments;
for (const box of document.querySelectorAll(`[data-trace^="trace-${plot}-"]`))
  if (box.checked !== shown.includes(box.dataset.trace)) box.click();
requestAnimationFrame(() => setTimeout(done, 50));
"""
"""Script that shows the given traces of a plot and hides all other traces."""
TRACES = "return [...document.querySelectorAll('.plots input')].map(box => box.dataset.trace)"
RANGES = "return Bokeh.documents[0].roots().map(p => [p.x_range.start, p.x_range.end]);"


COMMANDS = {
    "reproduction": "reproduce",
    "log": "estimate knee.parquet",
    "sweep": "sweep --modality RESIDUAL,SENSOR --seeds 2 --set estimator.motor.D_theta=0.9e-3,1e-3 "
    "--set 'plant.link.M=normal(0.1,0.01)'",
}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Returns the folder with results and report of a kind; each folder is computed once."""

    @cache
    def make(kind: str) -> Path:
        cwd, shell = tmp_path_factory.mktemp(kind), Shell()
        with working_in(cwd):
            if kind == "log":
                write_log(awas_log(0.5, 0.1), Path("knee.parquet"), CONFIGURATION)
            shell.run(f"{COMMANDS[kind]} --out out")
            assert shell.err == ""
            assert str(cwd / "out" / "report.html") in shell.run("report out")
            assert shell.err == ""
        return cwd / "out"

    return make


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    with opened("about:blank") as page:
        yield page


@pytest.mark.parametrize(("kind", "plots"), [("reproduction", 7), ("log", 7), ("sweep", 4)])
@pytest.mark.slow("a browser draws the report")
def test_the_file_alone_shows_every_plot(
    kind: str, plots: int, results: Callable[[str], Path], page: Page, tmp_path: Path
) -> None:
    file = results(kind) / "report.html"
    assert file.stat().st_size < 5_000_000
    alone = tmp_path / "moved.html"
    alone.write_bytes(file.read_bytes())
    page.show(alone)
    assert page.complaints() == []
    assert page.requests() == [alone.as_uri()]
    assert len(page.run(RANGES)) == plots
    traces = page.run(TRACES)
    for plot in range(plots):
        shown = []
        for trace in [None, *(t for t in traces if t.startswith(f"trace-{plot}-"))]:
            shown.append(trace)
            page.driver.execute_async_script(SHOW, plot, shown)
            changed = page.run(CHANGED, plot)
            assert changed or trace is None, trace
    assert page.complaints() == []


def test_the_plots_have_the_numbers_of_the_files(
    results: Callable[[str], Path], page: Page
) -> None:
    folder = results("reproduction")
    table = pa.csv.read_csv(folder / "SENSOR.csv")
    page.show(folder / "report.html")
    time = np.array(page.run(DATA, "trace-0-2", "x"))
    sigma = np.array(page.run(DATA, "trace-0-2", "trace-0-2"))
    box = "document.querySelector('[data-trace=\"trace-0-2\"]')"
    assert page.run(f"return {box}.parentElement.innerText").strip() == "SENSOR"
    assert np.array_equal(time, table["t [s]"].to_numpy())
    assert np.array_equal(sigma, table["sigma [N.m/rad]"].to_numpy().astype(np.float32))


def test_a_log_has_the_numbers_of_its_table(results: Callable[[str], Path], page: Page) -> None:
    folder = results("log")
    table = read_estimate(folder)
    sigma = table["estimate.sigma [N.m/rad]"].to_numpy()
    later = sigma[len(sigma) // 2 :]
    rms = np.sqrt(np.mean(later**2))
    cells = [f"{x:.4g}" for x in (sigma[-1], later.min(), later.max(), rms)]
    page.show(folder / "report.html")
    rows = page.run(ROWS, "Outputs of the estimator")
    assert rows[0].split() == ["\u03c3", "[N·m/rad]", *cells]
    assert page.run(ROWS, "Doubt")[-1].split() == ["NoClaim", "100"]
    drawn = np.array(page.run(DATA, "trace-2-0", "trace-2-0"))
    assert np.array_equal(drawn, sigma.astype(np.float32))


def test_a_sweep_has_the_numbers_of_its_summary(results: Callable[[str], Path], page: Page) -> None:
    folder = results("sweep")
    with (folder / "summary.csv").open() as file:
        summary = list(csv.DictReader(file))
    table = pa.parquet.read_table(folder / "sweep.parquet").to_pylist()
    page.show(folder / "report.html")
    rows = [r.text for r in page.driver.find_elements(By.CSS_SELECTOR, "tbody tr")]
    masses = page.run(DATA, "trace-3-1", "x")
    errors = page.run(DATA, "trace-3-1", "trace-3-1")
    assert len(rows) == len(summary) == 4
    for row, each in zip(rows, summary, strict=True):
        assert each["estimation"] in row
        assert f"{float(each['msrep [%]']):.4g} +- " in row
    own = [row for row in table if row["estimation"] == "RESIDUAL"]
    assert masses == [row["plant.link.M [kg.m2]"] for row in own]
    assert errors == [row["msrep_settled [%]"] for row in own]


def test_a_page_fits_a_phone(results: Callable[[str], Path]) -> None:
    with opened(results("sweep") / "report.html", width=400) as page:
        assert page.complaints() == []
        assert page.run("return document.documentElement.scrollWidth") <= 400


def test_names_are_not_taken_for_html(results: Callable[[str], Path], shell: Shell) -> None:
    folder = Path("<b>&")
    folder.mkdir()
    (folder / "sweep.parquet").write_bytes((results("sweep") / "sweep.parquet").read_bytes())
    assert shell.run("report '<b>&' --out r.html --quiet") == shell.err == ""
    assert html.escape("Sweep: <b>&") in Path("r.html").read_text()


@pytest.mark.parametrize("samples", [1, 2, 5, 4000, 4001, 4321, 100_000, 123_457])
def test_fewer_points_of_a_long_signal_keep_every_peak(samples: int) -> None:
    generator = np.random.default_rng(samples)
    t = np.arange(samples) * 1e-3
    x = generator.normal(size=samples).astype(np.float32)
    x[generator.integers(samples)] = 100.0
    x[generator.integers(samples)] = -100.0
    reduced = reduce(t, {"x": x, "minus": -x}, budget=8000)
    shown = reduced.signals["x"]
    assert len(reduced.t) == len(shown) <= 4002
    assert (shown.max(), shown.min()) == (x.max(), x.min())
    assert np.all(np.diff(reduced.t) >= 0)
    # The reduction shifts an extreme value by at most one bucket of time.
    width = reduced.bucket * 1e-3
    for value in (x.max(), x.min()):
        (at,) = t[x == value]
        assert np.abs(reduced.t[shown == value] - at).min() <= width
    # The reduced signal contains every sample of an interval in the middle.
    first, last = reduced.whole or (t[0], t[-1])
    inside = (t >= first) & (t <= last)
    start = int(np.searchsorted(reduced.t, first))
    middle = slice(start, start + int(np.count_nonzero(inside)))
    assert np.array_equal(reduced.t[middle], t[inside])
    assert np.array_equal(shown[middle], x[inside])


@pytest.mark.parametrize(
    ("files", "words"),
    [
        (None, "expected results of `sigmahat reproduce`, `estimate` or `sweep` (one of the files"),
        ({}, "expected results of"),
        ({"runs.sqlite": b""}, "incomplete sweep; run the command of the sweep again"),
        ({"sweep.parquet": b"PAR1 cut off"}, "expected the table of a sweep; run the sweep again"),
        ({"estimate.parquet": b"PAR1 cut off"}, "parquet: damaged; run `sigmahat estimate` again"),
        ({"estimate.csv": b""}, "csv: not readable as CSV; run `sigmahat estimate` again"),
        ({"estimate.csv": b"t,x\n1,2\n"}, "csv: expected a table of `sigmahat estimate`"),
        ({"table.csv": b"estimation,seeds\nRESIDUAL,1\n"}, "results of `sigmahat reproduce`"),
        ({"table.csv": b"a,b\n1\n"}, "not readable as CSV"),
    ],
)
def test_bad_input(files: dict[str, bytes] | None, words: str, shell: Shell) -> None:
    if files is not None:
        Path("in").mkdir()
        for name, content in files.items():
            Path("in", name).write_bytes(content)
    line = shell.refused("report in --out r.html")
    assert line.startswith("sigmahat: error: in") and words in line
