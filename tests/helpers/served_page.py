"""`sigmahat open` in a process of its own, and what a user does in a window of it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.ui import Select

from browser import Page

_FIND = """
const model = Bokeh.documents[0]?.get_model_by_name(arguments[0]);
const view = model ? Bokeh.index.find_one(model) : null;
return view?.shadow_el.querySelector("input,select,button") ?? null;
"""
_TEXT = """
const texts = node => [...node.childNodes].map(child =>
  child.nodeType === 3 ? child.data
  : ["STYLE", "SCRIPT"].includes(child.tagName) ? ""
  : child.shadowRoot ? texts(child.shadowRoot) : texts(child)).join(" ");
return texts(document.body);
"""
_LONGEST = 90.0  # [s] for all that a page computes


class Served:
    """The command while it runs."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        assert process.stdout is not None
        process.stdout.readline()  # that the log is open
        self.address = process.stdout.readline().strip()

    def interrupt(self) -> tuple[int, str, str]:
        """Ctrl-C. Returns the exit status, and the output after the address."""
        self.process.send_signal(signal.SIGINT)
        status = self.process.wait(timeout=_LONGEST)
        # The method communicate() cannot be used, because some lines were already read.
        assert self.process.stdout is not None and self.process.stderr is not None
        return status, self.process.stdout.read(), self.process.stderr.read()


@contextmanager
def served(*arguments: str, folder: Path, browser: str = "true") -> Iterator[Served]:
    """Runs `sigmahat open` until the end of the block.

    browser  the program that it takes for a browser
    """
    command = [sys.executable, "-m", "sigmahat", "open", *arguments]
    environment = {**os.environ, "BROWSER": browser, "PATH": "/bin", "PYTHONUNBUFFERED": "1"}
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=pipe, stderr=pipe, text=True
    )
    try:
        yield Served(process)
    finally:
        process.kill()
        process.communicate()


class Hand:
    """Actions of a user in a window, by the names of the inputs."""

    def __init__(self, page: Page) -> None:
        self.page = page

    def find(self, name: str) -> WebElement:
        """The input or button of a name, as soon as it is there."""
        found: WebElement = self.page.until(lambda: self.page.run(_FIND, name), name)
        return found

    def value(self, name: str) -> str:
        return str(self.page.run("return arguments[0].value", self.find(name)))

    def types(self, name: str, text: str) -> None:
        """Replaces the text, and leaves the field."""
        self.find(name).send_keys(Keys.CONTROL, "a", Keys.NULL, text, Keys.TAB)

    def chooses(self, name: str, item: str) -> None:
        Select(self.find(name)).select_by_visible_text(item)

    def presses(self, name: str) -> None:
        self._click(self.find(name))

    def _click(self, button: WebElement) -> None:
        self.page.run("arguments[0].scrollIntoView({block: 'center'})", button)
        button.click()

    def accepts(self, name: str) -> None:
        """Presses "accept" beside a finding until its value is in the input.

        When a check has ended, the page draws the findings and their buttons again.
        """
        before = self.value(name)

        def is_accepted() -> bool:
            button = self.page.run(_FIND, f"accept {name}")
            if self.value(name) == before and button:
                self._click(button)
                time.sleep(0.5)
            return self.value(name) != before

        self.page.until(is_accepted, f"accept {name}")

    def text(self) -> str:
        return " ".join(str(self.page.run(_TEXT)).split())

    def sees(self, words: str) -> None:
        self.page.until(lambda: words in self.text(), words)
