from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Episode
from latentarm.demonstrations.dataset import write_dataset
from latentarm.tasks.table_top import TableTop
from latentarm_research.studies.compare.preset import Preset


@pytest.fixture(scope="session")
def tiny() -> Preset:
    return Preset(
        "paper",
        models=("pca", "cae"),
        noises_rad=(0.0, 0.05),
        folds=2,
        seeds=2,
        epochs=1,
        searched_pairs=20,
        reach_pairs=2,
        turned_states=3,
        demonstrations=(1,),
        drives=1,
        drive_limit_s=0.5,
        ours="cae",
    )


@pytest.fixture(scope="session")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five short demonstrations by a simulated person, at 5 Hz."""
    shown = TableTop().demonstrate(5, np.random.default_rng(0))
    episodes = tuple(Episode(one.state[::4], one.timestamp[::4], task=one.task) for one in shown.episodes)
    path = tmp_path_factory.mktemp("data") / "table"
    write_dataset(replace(shown, episodes=episodes, rate_hz=5.0), path)
    return path
