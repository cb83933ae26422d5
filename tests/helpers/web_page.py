"""Actions of a user on the page that runs plant and estimator in the browser."""

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
from numpy.typing import NDArray

from browser import Page, opened

_DROP = """
const data = new DataTransfer();
data.items.add(new File([arguments[1]], arguments[0]));
document.getElementById("drop").dispatchEvent(
  new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
"""
_FILL = """
for (const [name, value] of Object.entries(arguments[0])) {
  const field = log.form.elements[name];
  field[field.type === "checkbox" ? "checked" : "value"] = value;
  field.dispatchEvent(new Event("change", { bubbles: true }));
}
"""


def csv(columns: Mapping[str, NDArray[np.float64]]) -> str:
    text = io.BytesIO()
    pyarrow.csv.write_csv(pa.table(dict(columns)), text)
    return text.getvalue().decode()


class WebPage:
    """The page, as soon as the binaries are compiled; its time stands still until `runs(True)`."""

    def __init__(self, page: Page) -> None:
        self.page = page
        page.driver.execute_async_script("opened.then(arguments[0])")
        self.runs(False)

    def runs(self, running: bool) -> None:
        """Starts or stops the time of the simulated joint."""
        self.page.run("joint.run(arguments[0])", running)

    def text(self, name: str) -> str:
        """Text of an element, by its id; empty if it is hidden."""
        return str(self.page.driver.find_element("id", name).text)

    def sets(self, name: str, value: object) -> None:
        """Moves a setting of the simulated joint."""
        script = "const field = joint.form.elements[arguments[0]]; field.value = arguments[1];"
        event = 'field.dispatchEvent(new Event("input", { bubbles: true }));'
        self.page.run(script + event, name, value)

    def time(self) -> float:
        """Time of the simulated joint, as the page shows it [s]."""
        return float(self.text("value-t").removesuffix(" s"))

    def arrays(self, script: str, *arguments: object) -> dict[str, NDArray[np.float64]]:
        """Result of a script: arrays of numbers by name."""
        found = f"Object.entries((() => {{ {script} }})())"
        lists = f"{found}.map(([name, array]) => [name, Array.from(array)])"
        result = self.page.run(
            f"const given = arguments; return Object.fromEntries({lists})", *arguments
        )
        return {name: np.array(values, dtype=np.float64) for name, values in result.items()}

    def drops(self, text: str, name: str = "log.csv") -> str:
        """Drops a file on the page, and returns the error message; empty if the file is valid."""
        self.page.run(f"{_DROP} log.form.hidden = true;", name, text)
        self.page.until(lambda: self.text("log-message") or self.text("log-name"))
        return self.text("log-message")

    def fills(self, fields: Mapping[str, object]) -> None:
        self.page.run(_FILL, fields)

    def estimates(self, fields: Mapping[str, object]) -> str:
        """Fills in the fields for the log, and starts the estimation. Returns the error message, or
        what is missing.
        """
        self.fills(fields)
        self.page.run("log.form.requestSubmit()")
        self.page.until(lambda: self.refusal() or self.text("answer"))
        return self.refusal()

    def refusal(self) -> str:
        return self.text("missing") or self.text("log-message")

    def columns_of_run(self, names: Sequence[str]) -> dict[str, NDArray[np.float64]]:
        script = "return Object.fromEntries(given[0].map((n) => [n, log.run.columns[n]]))"
        return self.arrays(script, names)


@contextmanager
def web_page(folder: Path, width: int = 1400, dark: bool = False) -> Iterator[WebPage]:
    """Opens the page from its folder, without a server."""
    with opened(folder / "index.html", width, dark) as page:
        yield WebPage(page)
