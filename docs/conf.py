"""Configuration of the site: `cmake --workflow --preset docs` builds it with Sphinx."""

import sys
from pathlib import Path

import tomlkit

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(Path(__file__).parent / "extensions"))

_about = tomlkit.parse((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")).unwrap()
project = "sigmahat"
release = version = _about["project"]["version"]
html_title = f"sigmahat {version}"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "fmu_variables",
    "mathml",
    "repository_links",
]

# Pages are read on GitHub, too: there and here, headings have the same anchors.
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]
highlight_language = "none"  # of indented blocks: commands with their comments
copybutton_exclude = ".linenos, .gp, .c"  # comments behind commands are not for the shell

smartquotes = False  # theta'' is a derivative

# Docstrings are prose; `name` in them is a name of the package, if there is one.
default_role = "py:obj"
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {name: name for name in ("NDArray", "Signal")}

html_theme = "pydata_sphinx_theme"
html_theme_options = {
    "logo": {"text": "sigmahat"},
    "show_toc_level": 2,
    "header_links_before_dropdown": 8,  # all
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}  # light or dark, as in the system
html_sidebars: dict[str, list[str]] = {"index": [], "web": []}
copyright = "sigmahat, BSD-2-Clause"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
