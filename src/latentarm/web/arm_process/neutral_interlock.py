"""Inputs whose meaning or device has changed count as zero until the person has let go once."""

from dataclasses import replace
from typing import final

import numpy as np

from latentarm.control.input_port import InputSource
from latentarm.core.types import Input
from latentarm.web.arm_process.page_inputs import PageInputs


@final
class NeutralInterlock(InputSource):
    """The page's inputs, zero after a change of their meaning or of the deflected device."""

    def __init__(self, inputs: PageInputs) -> None:
        self._inputs = inputs
        self._held_by: tuple[str, int, str] | None = None
        self.waiting = False  # whether the stick has yet to be let go

    def demand(self) -> None:
        """Ignore deflections until the stick is let go: a push means something else from now on."""
        self.waiting = True

    def latest(self, now_s: float) -> tuple[Input, float]:
        """The newest input and its age. Requests to the gripper pass: they mean the same as before."""
        given, age_s = self._inputs.latest(now_s)
        before, self._held_by = self._held_by, self._inputs.held_by
        if before is not None and self._held_by not in (None, before):
            self.demand()
        if self.waiting and self._inputs.fresh and not self._inputs.deflected:
            self.waiting = False
        return (replace(given, u=np.zeros_like(given.u)) if self.waiting else given), age_s
