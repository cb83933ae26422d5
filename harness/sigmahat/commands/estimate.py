"""sigmahat estimate"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread

import click

from sigmahat.commands import common


@click.command()
@common.log_argument
@common.config_option("File from `sigmahat init`.")
@click.option(
    "--out",
    callback=common.folder,
    help="Folder for table and figure.  [default: sigmahat-results/LOG]",
)
@click.option(
    "--start-from",
    type=click.Path(path_type=Path),
    help="Go on from what was learned before: the folder of another log, or its state.json.",
)
@common.json_option
@common.quiet_option
def estimate(log: Path, config: Path | None, out: Path | None, start_from: Path | None) -> None:
    """Replay LOG through the estimator, and add the stiffness to its table.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag; `sigmahat init LOG` writes the
    configuration. Writes a table (CSV for CSV, else Parquet), the stiffness over the deformation
    (estimate.curve.csv), a figure, a data sheet of the joint
    (joint.json) for `sigmahat export`, and what was learned (state.json) for --start-from.

    \b
    Example: sigmahat estimate knee.parquet --config knee.toml --out knee
    """
    from sigmahat.checks.check import check
    from sigmahat.checks.findings import as_dict
    from sigmahat.checks.text import IN_LOG, sentence
    from sigmahat.checks.text import summary as of_checks
    from sigmahat.files.output_folder import output_folder
    from sigmahat.logs.configuration import read_configuration
    from sigmahat.logs.estimate import estimate as run
    from sigmahat.logs.readers.formats import open_log
    from sigmahat.logs.summary import summary
    from sigmahat.report.findings import ShownFinding, write_findings

    common.need_fmu("StiffnessEstimator")
    out = out or Path("sigmahat-results", log.stem)
    with common.errors_in_one_line(out):
        opened = open_log(log)
        configuration = read_configuration(config or common.configuration_of(log))
        # Check and figure need them; reading and replaying the log need little of Python.
        Thread(target=_import, args=["scipy.signal", "matplotlib.figure"]).start()
        checked = check(opened, configuration)
        with output_folder(out) as folder, common.progress("Replaying", 1000) as bar:
            result = run(opened, configuration, folder, bar.update, start_from)
            shown = [ShownFinding(f.severity.value, sentence(f)) for f in checked.findings]
            write_findings(shown, folder)
    where = f"Table, curve, figure (PNG, SVG), joint.json and state.json are in {out.resolve()}"
    text = f"{summary(result)}\n\n{of_checks(checked, IN_LOG)}\n\n{where}"
    common.answer(text, {**result.as_dict(), "checks": as_dict(checked)})


def _import(*modules: str) -> None:
    """Imports modules before they are needed; a failure shows then."""
    with suppress(ImportError):
        for module in modules:
            import_module(module)
