"""Any robot from a MuJoCo (MJCF) or URDF file."""

from pathlib import Path

from latentarm.errors import UserError
from latentarm.robots.robot import Robot


def load_model_file(path: Path, end_effector: str | None = None) -> Robot:
    """Load a robot from an MJCF or URDF file."""
    raise UserError(f"{path}: model files cannot be read yet.")
