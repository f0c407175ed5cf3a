"""Simulated people and drives, the paper's studies and user studies, and the measurements behind the docs."""

from latentarm_research.metrics import measures as measures  # adds its own to those of models

__version__ = "0.1.0"
