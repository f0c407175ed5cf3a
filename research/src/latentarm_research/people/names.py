"""What the simulated people are called."""

from typing import Literal

OperatorName = Literal["greedy", "learning", "reading", "unsteady", "planning"]
