"""The priors of what real joints have besides a spring and a motor."""

from __future__ import annotations

WITHOUT_MISFITS = {
    f"prior.{name}": 0.0
    for name in (
        *("bias", "damping", "load_friction", "eccentric", "delay", "reversal"),
        *("power", "gap", "hysteresis", "eccentric_motor"),
    )
}
"""Parameters of FilteredRegression without the columns for misfits."""
