"""How long a frame of the page in the browser takes: docs/live.md.

    PYTHONPATH=tests/helpers build/venv/bin/python tests/studies/frames.py build/site/live

Prints, for each speed and width, frames per second over 5 s, and the time of the page's own work in
a frame: samples of plant and estimator, and drawing.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from live_page import LivePage, live_page

_MEASURE = """
const frame = joint.frame;
const measured = { starts: [], work: [] };
joint.frame = function (now) {
  const begin = performance.now();
  frame.call(this, now);
  measured.starts.push(now);
  measured.work.push(performance.now() - begin);
};
window.measured = measured;
"""
_SECONDS = 5.0


def measure(page: LivePage, method: str, speed: str) -> str:
    """A row of the table."""
    page.page.run("joint.form.elements.method.value = METHODS[arguments[0]]", method)
    page.sets("speed", speed)
    # The plots are full: every sample of 15 s is drawn in every frame.
    page.page.run("joint.start(); joint.advance(15000, Infinity)")
    page.runs(True)
    time.sleep(0.5)
    page.page.run("measured.starts.length = measured.work.length = 0")
    time.sleep(_SECONDS)
    found = page.arrays("return window.measured")
    page.runs(False)
    intervals, work = np.diff(found["starts"]), found["work"]
    rate = f"{1000 / np.mean(intervals):8.1f}  {intervals.max():21.1f}"
    parts = f"{np.median(work):19.2f}  {np.quantile(work, 0.99):9.2f}  {work.max():8.2f}"
    return f"{method:13}  {speed:>3} x  {rate}  {parts}"


def main() -> None:
    """Prints the table."""
    folder = Path(sys.argv[1]).resolve()
    print("width  method         speed  frames/s  longest interval [ms]", end="  ")
    print("work [ms]: median       99 %       max")
    for width in (1400, 360):
        with live_page(folder, width) as page:
            page.page.run(_MEASURE)
            for method in ("Paper2011", "FilteredRegression"):
                for speed in ("1", "10"):
                    print(f"{width:5}  {measure(page, method, speed)}")


if __name__ == "__main__":
    main()
