"""Figures as files, all in one style."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
from matplotlib.figure import Figure
from PIL import Image

Source = TypeVar("Source")  # data of a figure

_STYLE: Any = {
    "font.size": 9,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "lines.linewidth": 1.0,
    "savefig.dpi": 150,
    "svg.hashsalt": "sigmahat",  # the same picture gives the same file
}


def save(draw: Callable[[Source], Figure], source: Source, path: Path) -> None:
    """Draws a figure into <path>.png and <path>.svg. The same source gives the same SVG."""
    with matplotlib.rc_context(_STYLE):
        figure = draw(source)
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
        figure.set_layout_engine("none")  # the layout is kept, because it takes long to compute
        pixels = BytesIO()
        figure.savefig(pixels, format="png", pil_kwargs={"compress_level": 0})
    with Image.open(pixels) as image:  # 256 colours look the same in a third of the bytes
        few = image.convert("RGB").quantize(256, method=Image.Quantize.FASTOCTREE)
        few.save(path.with_suffix(".png"))
