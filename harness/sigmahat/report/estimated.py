"""Estimates from a log, and writes a folder of results, with the findings of the checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from sigmahat.files.output import output_folder
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.estimate import Estimate, estimate
from sigmahat.logs.log import Log
from sigmahat.report.from_log import ShownFinding, write_findings


def estimated(
    log: Log,
    configuration: Configuration,
    findings: Sequence[tuple[str, str]],
    out: Path,
    progress: Callable[[int], object] = lambda thousandths: None,
    start_from: Path | None = None,
    mcap: bool = False,
) -> Estimate:
    """Returns the estimate, and writes estimate and findings into out: all files, or no file.

    findings  of the checks: severity and sentence
    mcap      whether estimate.mcap is written, too

    Raises what `estimate` raises, OSError if out cannot be written to.
    """
    with output_folder(out) as folder:
        result = estimate(log, configuration, folder, progress, start_from, mcap)
        write_findings([ShownFinding(*each) for each in findings], folder)
    return result
