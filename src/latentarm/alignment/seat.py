"""Where a person sits, seen from the arm."""

from typing import Literal

Seat = Literal["facing", "behind"]
"""Where a person sits: facing the arm or behind it."""
