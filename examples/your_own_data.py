"""From joint positions in NumPy arrays to a dataset on disk that `latentarm train` and LeRobot read."""

import sys
import tempfile
from pathlib import Path

import numpy as np

from latentarm.demonstrations.dataset import append_episode, read_dataset, write_dataset
from latentarm.demonstrations.validation import validate
from latentarm.robots.catalogue import load_robot
from latentarm.types import Demonstrations, Episode

folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()) / "lifts"
robot = load_robot("panda")
time_s = np.arange(0.0, 3.0, 0.1)


def lift(height: float) -> Episode:
    """A slow lift; put your recording here: states (T, 7), rad, and their times (T,), s."""
    state = robot.home + np.outer(1 - np.cos(time_s), [0, -height, 0, height, 0, 0, 0])
    return Episode(state=state, timestamp=time_s, task="lift the cup")


demonstrations = Demonstrations(
    episodes=(lift(0.1), lift(0.15)), rate_hz=10.0, joint_names=robot.joint_names, robot=robot.name
)
validate(demonstrations, "my recording", robot.limits)
write_dataset(demonstrations, folder)
append_episode(folder, lift(0.2))
print(f"{len(read_dataset(folder).episodes)} episodes; next: latentarm train --demonstrations {folder}")
