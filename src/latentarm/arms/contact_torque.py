"""Torques that a simulated arm's surroundings exert on its joints."""

from collections import deque
from typing import Final, final

import mujoco
import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.reader import ModelChain

_EQUALITY: Final = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
_CONTACT: Final = int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)  # the first of the contacts' kinds
_WELD: Final = int(mujoco.mjtEq.mjEQ_WELD)

LOOKS: Final = 3
"""Samples whose median is the estimate: a finger may lose contact with a stiff cup for one time step."""


@final
class ContactTorque:
    """Reads them out of a simulation, as a real arm's own estimate has them.

    All contacts of the arm count, and the welds that hold food on tines: so what is held, its weight and what
    it touches count too. Limits of joints, their friction and their servos do not.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, arm: ModelChain) -> None:
        self._model, self._data = model, data
        self._joints, self._ratio = model.jnt_dofadr[arm.link_joints], arm.chain.ratio
        self._welds = model.eq_type == _WELD
        self._generalized = np.zeros(model.nv)
        self._looks: deque[FloatArray] = deque(maxlen=LOOKS)

    def estimate(self) -> FloatArray:
        """(n,), N m (N where a joint slides)."""
        if not self._looks:
            return np.zeros(self._ratio.shape[1])
        # Not `np.median`, which takes four times as long for so few.
        return np.sort(self._looks, axis=0)[LOOKS // 2]

    def look(self) -> None:
        """Sample the last time step."""
        self._looks.extend([self._now()] * (1 if self._looks else LOOKS))

    def _now(self) -> FloatArray:
        kind, index = self._data.efc_type, self._data.efc_id
        counts = kind >= _CONTACT
        held = kind == _EQUALITY
        counts[held] = self._welds[index[held]]
        if not counts.any():
            return np.zeros(self._ratio.shape[1])
        forces = np.where(counts, self._data.efc_force, 0.0)
        mujoco.mj_mulJacTVec(self._model, self._data, self._generalized, forces)
        return self._generalized[self._joints] @ self._ratio
