"""README and pages of documentation show the examples, and their links exist.

test_examples.py checks what the Python program prints, the build of the site all links of docs/.
"""

from __future__ import annotations

import re
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"


def test_the_program_of_the_page_is_the_example() -> None:
    (program,) = re.findall(r"```python\n(.*?)```", (DOCS / "fmu.md").read_text(), re.DOTALL)
    assert program == (REPOSITORY / "examples" / "fmpy_ten_lines.py").read_text(encoding="utf-8")


def test_the_links_of_the_readme_exist() -> None:
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)(?:#([^)]*))?\)", readme)
    assert len(links) > 10
    for target, anchor in links:
        text = (REPOSITORY / target).read_bytes()
        if anchor:
            headings = re.findall(r"^#+ (.*)$", text.decode(), re.MULTILINE)
            assert anchor in {heading.lower().replace(" ", "-") for heading in headings}
