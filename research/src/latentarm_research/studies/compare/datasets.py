"""The datasets of the comparison, and their folds."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.split import Fold, make_folds
from latentarm.robots.catalogue import load_recorded_robot
from latentarm_research.studies.compare.preset import Stream
from latentarm_research.studies.streams import sequence


@dataclass(frozen=True, eq=False)
class Dataset:
    """Demonstrations, what they are called, and which of them are held out when."""

    name: str  # of the folder
    demonstrations: Demonstrations  # all episodes
    folds: tuple[Fold, ...]  # every episode is held out in one of them

    @property
    def left(self) -> int:
        """Least number of episodes outside a fold."""
        return min(len(fold.others) for fold in self.folds)


def read_datasets(paths: Sequence[Path], folds: int, seed: int) -> list[Dataset]:
    """Read datasets of one robot and cut each into folds."""
    found: list[Dataset] = []
    for path in paths:
        demonstrations, name = read_dataset(path), path.resolve().name
        _check_robot(path, demonstrations, found)
        rng = np.random.default_rng(sequence(seed, name, Stream.FOLDS))
        try:
            found.append(Dataset(name, demonstrations, make_folds(len(demonstrations.episodes), folds, rng)))
        except UserError as error:
            raise UserError(f"{path}: {error}") from error
    return found


def _check_robot(path: Path, demonstrations: Demonstrations, before: Sequence[Dataset]) -> None:
    robot = demonstrations.robot
    joints = load_recorded_robot(demonstrations, str(path)).dof
    for other in before:
        if other.demonstrations.robot != robot:
            raise UserError(
                f"{path} is of robot {robot}, and {other.name} of {other.demonstrations.robot}: compare on"
                " datasets of one robot."
            )
    if demonstrations.dof != joints:
        raise UserError(f"{path} has {demonstrations.dof} joints, but robot {robot} has {joints}.")
