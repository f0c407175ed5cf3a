"""A latest-value slot for inputs from other threads, with a freshness check."""

import math
import secrets
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from typing import final

import numpy as np
from typing_extensions import override

from latentarm.arms.contract import INPUT_BUDGET_S
from latentarm.control.clock import Clock
from latentarm.core.types import FloatArray, GripperAsk, Input

_KEPT_NONCES = 1024


class InputSource(ABC):
    """Gives the loop the person's newest input, without ever waiting for it."""

    @abstractmethod
    def latest(self, now_s: float) -> tuple[Input, float]:
        """The newest input, and for how long it has been the newest, s; infinite where there is none."""


@final
class InputPort(InputSource):
    """Accepts inputs of d axes from any thread and judges their freshness by the loop's clock alone.

    The loop's side issues nonces. The sender of inputs echoes the newest nonce that it has seen, with a
    sequence number that grows. A message that was delayed in either direction is thus detected without
    trusting the sender's clock. At most one input is kept. A press of the mode switch, or a request to the
    gripper, is not lost when a later input replaces it before the loop has looked.

    Args:
        input_dim: d.
        clock: of the loop.
        budget_s: an input must echo a nonce no older than this, s; see `ArmSpec.input_budget_s`.
    """

    def __init__(self, input_dim: int, clock: Clock, budget_s: float = INPUT_BUDGET_S) -> None:
        self._clock = clock
        self._budget_s = budget_s
        self._lock = threading.Lock()
        self._issued: OrderedDict[str, float] = OrderedDict()
        self._sequence = -1
        self._u: FloatArray = np.zeros(input_dim)
        self._switch = False
        self._pressed = False
        self._opens = False
        self._gripper: GripperAsk | None = None
        self._asked: GripperAsk | None = None
        self._issued_s = self._received_s = -math.inf

    def issue_nonce(self) -> str:
        """A new nonce for the sender to echo, 128 random bits in hexadecimal."""
        nonce = secrets.token_hex(16)
        with self._lock:
            self._issued[nonce] = self._clock.now_s()
            while len(self._issued) > _KEPT_NONCES:
                self._issued.popitem(last=False)
        return nonce

    def nonce_age_s(self, nonce: str) -> float:
        """How long ago a nonce was issued, s; infinite where it was not, or in the future."""
        with self._lock:
            age_s = self._clock.now_s() - self._issued.get(nonce, -math.inf)
        return age_s if age_s >= 0.0 else math.inf

    def offer(self, given: Input, nonce: str, sequence: int) -> bool:
        """Hand in an input; whether it was accepted: the nonce must be fresh, the sequence number grow."""
        # Comparisons with NaN are false, so every later number would seem to be larger.
        if not _is_stamp(nonce, sequence):
            return False
        u = np.array(given.u)
        with self._lock:
            now_s = self._clock.now_s()
            issued_s = self._issued.get(nonce)
            if issued_s is None or sequence <= self._sequence:
                return False
            # A nonce from the future was issued before the clock went back.
            if not 0.0 <= now_s - issued_s <= self._budget_s:
                return False
            self._sequence = sequence
            self._u = u
            self._switch = bool(given.switch_mode)
            self._pressed |= self._switch
            self._opens = bool(given.opens)
            self._gripper = given.gripper
            self._asked = given.gripper or self._asked
            self._issued_s, self._received_s = issued_s, now_s
            return True

    @override
    def latest(self, now_s: float) -> tuple[Input, float]:
        # Infinitely old where the nonce has grown too old in the meantime, or where the clock has gone back.
        with self._lock:
            switch = self._switch or self._pressed
            self._pressed = False
            gripper, self._asked = self._gripper or self._asked, None
            age_s = now_s - self._received_s
            if now_s - self._issued_s > self._budget_s or self._received_s > self._clock.now_s():
                age_s = math.inf
            delay_s = self._received_s - self._issued_s
            return Input(self._u, switch, gripper, opens=self._opens, delay_s=delay_s), max(age_s, 0.0)


def _is_stamp(nonce: object, sequence: object) -> bool:
    return isinstance(nonce, str) and isinstance(sequence, int)
