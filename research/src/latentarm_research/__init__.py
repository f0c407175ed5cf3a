"""Simulated people and drives, the paper's studies and user studies, and the measurements behind the docs."""

__version__ = "0.1.0"
