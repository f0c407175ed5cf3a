"""What a decoder sees where nobody says it: things too, if every episode has them and they moved."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.models.saving import load_decoder
from latentarm.runs.options import TrainOptions
from latentarm.runs.training import train_run
from latentarm.tasks.table_top import TableTop

BESIDE = ("joints", "objects_in_tool")


def with_cup(shown: Demonstrations, moves_m: float) -> Demonstrations:
    """The same, with a cup that stands elsewhere in every episode."""

    def seen(number: int, one: Episode) -> Episode:
        row = [0.5, number * moves_m, 0.0, 1.0, 0.0, 0.0, 0.0]
        return replace(one, extras={**one.extras, ENVIRONMENT: np.tile(row, (len(one.state), 1))})

    episodes = tuple(seen(number, one) for number, one in enumerate(shown.episodes))
    return replace(shown, episodes=episodes, objects=("cup",))


def hardly_trained(data: Path, model: str = "scl") -> TrainOptions:
    hardly = TrainOptions((data,), model, out=data.with_name("run"), seeds=1)
    return hardly if model == "pca" else replace(hardly, epochs=1, hidden=(4,))


@pytest.fixture(scope="module")
def table() -> Demonstrations:
    return TableTop().demonstrate(3, np.random.default_rng(0))


def check(shown: Demonstrations, folder: Path, model: str, sees: tuple[str, ...]) -> None:
    write_dataset(shown, folder / "data")
    trained = train_run(hardly_trained(folder / "data", model))
    layout = load_decoder(folder / "run").layout
    assert trained.context == layout.features == sees
    assert trained.objects == layout.objects == (("cup",) if sees == BESIDE else ())


def test_a_decoder_sees_things_that_were_moved(table: Demonstrations, tmp_path: Path) -> None:
    check(with_cup(table, 0.1), tmp_path, "scl", BESIDE)


@pytest.mark.parametrize("why", ["stood still", "nameless", "none"])
def test_a_decoder_sees_the_joints_alone_where_things_tell_nothing(
    table: Demonstrations, tmp_path: Path, why: str
) -> None:
    nameless = replace(with_cup(table, 0.1), objects=())
    told = {"stood still": with_cup(table, 0.0), "nameless": nameless, "none": table}
    check(told[why], tmp_path, "scl", ("joints",))


def test_a_decoder_that_cannot_look_sees_the_joints_alone(table: Demonstrations, tmp_path: Path) -> None:
    check(with_cup(table, 0.1), tmp_path / "any", "pca", ("joints",))
    check(replace(with_cup(table, 0.1), robot="of nobody"), tmp_path / "unknown", "cae", ("joints",))


def test_what_is_asked_for_is_seen(table: Demonstrations, tmp_path: Path) -> None:
    write_dataset(with_cup(table, 0.1), tmp_path / "data")
    assert train_run(replace(hardly_trained(tmp_path / "data"), context=("joints",))).objects == ()
