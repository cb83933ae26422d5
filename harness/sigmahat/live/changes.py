"""Finds changes of the stiffness of one joint as the ticks come, by the rules for a log."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from sigmahat.fmi.model import Value
from sigmahat.live.events import StiffnessChanged
from sigmahat.result.replayed_log import Changes


class ChangesOnLine:
    """Gives result/replayed_log.py the ticks that it needs: the last confident one before a change,
    that of the change, and the first confident one after it, which shows the size.
    """

    def __init__(self, joint: str, parameters: Mapping[str, Value], T: float) -> None:
        """joint  its name; parameters  all of the estimator; T  time between ticks [s]"""
        self._joint = joint
        self._changes = Changes(parameters, T)
        self._age = -1.0
        self._confident: Mapping[str, Any] | None = None  # last confident tick, not given yet
        self._changed_at: float | None = None  # time of a change whose size is not known yet [s]

    @property
    def names(self) -> list[str]:
        """Names of the required outputs besides change_age, confident, phi and setPoint."""
        return self._changes.names

    def add(self, t: float, outputs: Mapping[str, Any]) -> StiffnessChanged | None:
        """Adds the outputs of the next tick, at t [s]. Returns the change that this tick shows."""
        age = float(outputs["change_age"])
        has_begun = age >= 0 and (age < self._age or self._age < 0)
        self._age = age
        if has_begun:
            if self._confident is not None:
                self._give(self._confident)
                self._confident = None
            count = len(self._changes.found)
            self._give(outputs)
            if len(self._changes.found) == count:
                return None  # the estimator has started again, and follows the same change
            self._changed_at = t
            return StiffnessChanged(t=t, joint=self._joint, changed_at=t, relative=None)
        if not outputs["confident"]:
            return None
        if self._changed_at is None:
            self._confident = outputs
            return None
        self._give(outputs)
        changed_at, self._changed_at = self._changed_at, None
        relative = self._changes.found[-1].relative
        if relative is None:
            return None
        return StiffnessChanged(t=t, joint=self._joint, changed_at=changed_at, relative=relative)

    def _give(self, outputs: Mapping[str, Any]) -> None:
        needed = (*self.names, "change_age", "confident", "phi", "setPoint")
        self._changes.add({name: np.array([outputs[name]]) for name in needed})
