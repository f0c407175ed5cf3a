"""Your own data: from joint positions in NumPy arrays to a dataset that `latentarm train` reads."""

import sys
import tempfile
from pathlib import Path

import numpy as np

import latentarm as la

folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()) / "lifts"
robot = la.load_robot("panda")
time_s = np.arange(0.0, 3.0, 0.1)


def lift(height: float) -> la.Episode:
    """A slow lift; put your recording here: states (T, 7), rad, and their times (T,), s."""
    state = robot.home + np.outer(1 - np.cos(time_s), [0, -height, 0, height, 0, 0, 0])
    return la.Episode(state=state, timestamp=time_s, task="lift the cup")


demonstrations = la.Demonstrations(
    episodes=(lift(0.1), lift(0.15)), rate_hz=10.0, joint_names=robot.joint_names, robot=robot.name
)
la.write_dataset(demonstrations, folder)
la.append_episode(folder, lift(0.2))
print(f"{len(la.read_dataset(folder).episodes)} episodes; next: latentarm train --demonstrations {folder}")
