"""The command that proposes a motion to record."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.motion.design import Design
    from sigmahat.motion.joints_of_log import Limits, Ranges


class _Number(click.FloatRange):
    """A number in a range. nan is refused separately, because no comparison excludes nan."""

    def convert(
        self, value: Any, param: click.Parameter | None, context: click.Context | None
    ) -> float:
        number = float(super().convert(value, param, context))
        if math.isnan(number):
            self.fail("expected a number, got nan.", param, context)
        return number


_POSITIVE = _Number(min=0, min_open=True, max=1e6)


def _limit(name: str, text: str) -> click.Option:
    return click.Option([f"--{name}"], type=_POSITIVE, required=True, help=text)


@common.command(
    "motion --angle 1 --velocity 2 --torque 100 --deformation 0.02",
    params=[
        _limit("angle", "Largest distance from the start position [rad]."),
        _limit("velocity", "Largest velocity [rad/s]."),
        _limit("torque", "Largest torque of the motor at the gear output [N.m]."),
        _limit("deformation", "Largest deformation of the transmission [rad]."),
    ],
)
@click.argument("config", required=False, type=common.FILE)
@common.option("--seconds", type=_Number(5, 600), default=30.0, help="Duration of the motion.")
@common.option(
    "--start",
    type=_Number(-1e6, 1e6),
    default=0.0,
    help="Start position of the motor at the gear output [rad].",
)
@click.option(
    "--after",
    type=common.PATH,
    help="Earlier log of this joint, to adapt the motion to it; CONFIG describes this log.",
)
@common.out_option("Folder to write into.", "motion")
@click.option("--joint", metavar="NAME", default="", help="Joint of CONFIG, if it has several.")
@common.answer_options
def motion(
    config: Path | None,
    angle: float,
    velocity: float,
    torque: float,
    deformation: float,
    seconds: float,
    start: float,
    after: Path | None,
    out: Path,
    joint: str,
) -> None:
    """Propose a motion of the motor that will show the stiffness of a joint.

    The motion is a sum of sines. It keeps the limits at the gear output for every joint of a set.
    The set has joints that fit the limits or, with --after, joints that fit the log. The motion
    stays below resonance, and begins and ends at rest. The command writes it as CSV, as a
    trajectory for ROS, and as C. CONFIG gives gear ratio, encoders and noise.
    """
    from sigmahat.files.output import output_folder
    from sigmahat.motion import design, files, known
    from sigmahat.motion.joints_of_log import Limits, of_limits
    from sigmahat.recording.configuration import read_configuration
    from sigmahat.recording.readers.formats import open_log

    common.need_fmus("StiffnessEstimator")
    if after is not None and config is None:
        raise click.UsageError("--after LOG needs CONFIG, the configuration of the log")
    limits = Limits(angle, velocity, torque, deformation)
    with common.errors_in_one_line(out):
        configuration = None if config is None else read_configuration(config, joint)
        joints = of_limits(limits)
        if after is not None and configuration is not None:
            joints = known.of_log(open_log(after, configuration.columns), configuration, start)
        sensors = known.sensors(configuration, limits)
        with common.progress("Trying motions", design.trials()) as bar:
            found = design.design(joints, limits, sensors, seconds, bar.update)
        with output_folder(out) as folder:
            files.write(found.motion, joint or "joint", start, sensors.T, folder)
    where = f"{', '.join(files.FILES)} are in {out.resolve()}"
    values = {
        "half_widths": found.half_widths,
        "peaks": vars(found.peaks),
        "motion": vars(found.motion),
        "joints": {"from": vars(joints.low), "to": vars(joints.high)},
    }
    text = "\n".join([*_lines(found, joints, limits), "", where])
    common.answer(text, values, _expected(found))


def _expected(found: Design) -> str:
    from sigmahat.motion.design import NOT_SHOWN

    median, most = (f"{100 * found.quantile(share):.2g} %" for share in (0.5, 0.9))
    others = f"nine of ten joints: +- {most} or less"
    if found.not_shown:
        others = f"not shown in {found.not_shown} of {len(found.half_widths)} joints"
    if found.quantile(0.5) > NOT_SHOWN:
        return f"expected: the stiffness is {others} after {found.motion.duration:g} s"
    return f"expected: stiffness +- {median} after {found.motion.duration:g} s ({others})"


def _lines(found: Design, joints: Ranges, limits: Limits) -> list[str]:
    motion, peaks, low, high = found.motion, found.peaks, joints.low, joints.high
    return [
        f"four sines, {motion.frequencies[0]:.3g} to {motion.frequencies[-1]:.3g} Hz",
        f"largest of all joints tried: {peaks.angle:.3g} of {limits.angle:g} rad, "
        f"{peaks.velocity:.3g} of {limits.velocity:g} rad/s, {peaks.torque:.3g} of "
        f"{limits.torque:g} N.m, deformation {peaks.deformation:.3g} of {limits.deformation:g} rad",
        f"joints: stiffness {low.k:.3g} to {high.k:.3g} N.m/rad, inertia of the link "
        f"{low.M:.3g} to {high.M:.3g} kg.m2,",
        f"  weight up to {high.weight:.3g} N.m, motor {low.B:.3g} to {high.B:.3g} kg.m2, "
        f"Coulomb friction up to {high.tau_coulomb:.3g} N.m",
        "no promise for other joints, and none for backlash, hysteresis or contact",
    ]
