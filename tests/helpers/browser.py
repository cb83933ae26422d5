"""Chromium without a window, to test reports and the site in a browser."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from selenium.common.exceptions import JavascriptException, StaleElementReferenceException
from selenium.webdriver import Chrome, ChromeOptions
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

from gate import need

_LONGEST = 90.0  # [s] for all that a page computes
# The page is drawing an element anew: it is gone, or there twice, for a moment.
_REDRAWN = (StaleElementReferenceException, JavascriptException)
_IDLE = """
const done = arguments[0];
const look = () => !document.querySelector(".plots") || (typeof Bokeh !== "undefined"
  && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle))
  ? done() : setTimeout(look, 20);
look();
"""

DATA = """
const model = [...Bokeh.documents[0]._all_models.values()]
  .find(m => m.name === arguments[0] && m.data_source?.data[arguments[1]]);
return Array.from(model.data_source.data[arguments[1]]);
"""
"""Values of a trace that is a line or points."""
ROWS = """
const section = [...document.querySelectorAll("section")]
  .find(s => s.querySelector("h2")?.textContent === arguments[0]);
return [...section.querySelectorAll("tbody tr")]
  .map(row => [...row.cells].map(cell => cell.textContent).join(" "));
"""
"""Returns the rows of a table, even if the table is folded."""


class Page:
    def __init__(self, driver: Chrome) -> None:
        self.driver = driver

    def show(self, file: Path | str) -> None:
        """Replaces the page by a file or an address, and waits until its plots are drawn."""
        self.complaints(), self.requests()
        self.driver.get(file if isinstance(file, str) else file.as_uri())
        self.driver.execute_async_script(_IDLE)

    def run(self, script: str, *arguments: object) -> Any:
        """Runs a script that ends with return. Returns its value."""
        return self.driver.execute_script(script, *arguments)

    def until(self, is_so: Callable[[], Any], what: str = "") -> Any:
        """Waits until an element exists or a condition is true. Returns it."""
        wait = WebDriverWait(self.driver, _LONGEST, 0.1, _REDRAWN)
        return wait.until(lambda _: is_so(), what)

    def complaints(self) -> list[str]:
        """Errors and warnings on the console since the last call."""
        entries = self.driver.get_log("browser")  # type: ignore[no-untyped-call]
        found = [e["message"] for e in entries if e["level"] not in ("INFO", "DEBUG")]
        # Chromium warns about the tests themselves, which read the pixels of the plots.
        return [message for message in found if "getImageData" not in message]

    def requests(self) -> list[str]:
        """Addresses requested since the last call, except those inside the file itself."""
        entries = self.driver.get_log("performance")  # type: ignore[no-untyped-call]
        events = [json.loads(entry["message"])["message"] for entry in entries]
        urls = [
            str(event["params"]["request"]["url"])
            for event in events
            if event["method"] == "Network.requestWillBeSent"
        ]
        return [url for url in urls if not url.startswith(("data:", "blob:"))]


@contextmanager
def opened(file: Path | str, width: int = 1400, dark: bool = False) -> Iterator[Page]:
    """Opens a file or an address, and waits until all plots of the page are drawn."""
    chromium, driver = need("chromium"), need("chromedriver")
    options = ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    chrome = Chrome(options, Service(driver))
    try:
        command = chrome.execute_cdp_cmd
        size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
        command("Emulation.setDeviceMetricsOverride", size)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        command("Emulation.setEmulatedMedia", {"features": [scheme]})
        chrome.set_script_timeout(60)
        page = Page(chrome)
        page.show(file)
        yield page
    finally:
        chrome.quit()
