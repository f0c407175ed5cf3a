"""Drives the candidates for the default model, and applies the rule of docs/decisions/0031 to the drives.

All candidates drive to three items on a table with all simulated people. With a recording they race along its
held-out episodes, the most promising first: a candidate whose interval of success cannot reach that of the
best any more, even if every further drive succeeded, is not driven on, because the rule's first step would
drop it whatever came. Every place that was driven is kept in a file and is not driven again. For example:
python scripts/default_model.py --models cvae scl homogeneous --recording pour --out default_model
"""

import argparse
import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any, Final

import numpy as np

from latentarm.commands.drive_at_goals import HELD_OUT_LIMIT_S, TIME_LIMIT_S
from latentarm.controllers.latent import LatentController
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.split import Fold, select_episodes
from latentarm.files import write_text
from latentarm.models.catalogue import DEFAULT_MODEL, KINDS
from latentarm.models.decoder import Decoder
from latentarm.models.saving import load_decoder
from latentarm.operators.catalogue import PEOPLE
from latentarm.robots.catalogue import load_recorded_robot
from latentarm.runs.training import TrainConfig, train_run
from latentarm.simulation.drive import STATE_NOISE_RAD, Setup, Trace
from latentarm.simulation.drives import drive_all
from latentarm.studies.compare.datasets import Dataset, read_datasets
from latentarm.studies.default_model import Candidate, choose, leader, may_stay, success_interval
from latentarm.studies.fitting import fit_model
from latentarm.tasks.replay import Replay, routes_of
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task

TABLE: Final = "table"

EPISODES: Final = 60
SEEDS: Final = 3
EPOCHS: Final = 16
"""Of the demonstrations at the table and of the training on them."""

Drives = dict[str, Any]
"""Of one model at one place: its training time, s, and every drive."""


def main(asked: argparse.Namespace) -> None:
    """Train, drive, write every drive, and say what the rule keeps at each step."""
    recordings = [] if asked.recording is None else [asked.recording]
    folds = [(one, fold) for one in read_datasets(recordings, asked.folds, asked.seed) for fold in one.folds]
    starts = {TABLE: asked.drives * len(TableTop().goals)}
    starts |= {f"fold {fold.index}": len(fold.held_out) for _, fold in folds}
    driven = {model: [_kept(asked, model, TABLE, partial(_table, model, asked))] for model in asked.models}

    def candidates() -> list[Candidate]:
        return [_candidate(model, places, starts, asked.people) for model, places in driven.items()]

    while (model := _next(candidates(), driven, len(starts))) is not None:
        dataset, fold = folds[len(driven[model]) - 1]
        drive = partial(_episodes, model, asked, dataset, fold)
        driven[model].append(_kept(asked, model, f"fold {fold.index}", drive))

    found = candidates()
    whole = [one for one in found if len(driven[one.kind.name]) == len(starts)]
    print("\nNot driven on, because no outcome of the other drives would have kept them:")
    for one in found:
        if one not in whole:
            known = sum(list(starts.values())[: len(driven[one.kind.name])])
            low, high = success_interval(one)
            print(
                f"  {one.kind.name:<16} {one.success[:known].mean():.3f} of the drives of {known} starts;"
                f" at most {one.success.mean():.3f} [{low:.3f}, {high:.3f}] of all"
            )
    for step in choose(whole):
        print(f"\n{step.rule}: {', '.join(step.kept)}")
        for name, figure in step.figures.items():
            print(f"  {name:<16} {figure}")
    print(f"\nThe default now is {DEFAULT_MODEL}.")


def _next(candidates: Sequence[Candidate], driven: dict[str, list[Drives]], places: int) -> str | None:
    """The most promising model that has not driven everywhere and may still stay."""
    on = [one for one in candidates if len(driven[one.kind.name]) < places]
    whole = [one for one in candidates if len(driven[one.kind.name]) == places]
    if whole:
        best = leader(whole)
        on = [one for one in on if may_stay(one, best)]
    return leader(on).kind.name if on else None


def _kept(asked: argparse.Namespace, model: str, place: str, drive: Callable[[], Drives]) -> Drives:
    """What was driven before, or is driven now."""
    path = asked.out / model / f"{place.replace(' ', '_')}.json"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(drive(), indent=1))
    return json.loads(path.read_text())


def _table(model: str, asked: argparse.Namespace) -> Drives:
    """The table with three items, with decoders trained on demonstrations there."""
    shown, run = asked.out / "table", asked.out / model / "run"
    task = TableTop()
    if not shown.exists():
        write_dataset(task.demonstrate(EPISODES, np.random.default_rng(asked.seed)), shown)
    began = process_time()
    train_run(
        TrainConfig(
            demonstrations=shown,
            model=model,
            out=run,
            seeds=SEEDS,
            seed=asked.seed,
            state_noise_rad=STATE_NOISE_RAD,
            epochs=EPOCHS,
        )
    )
    train_s = process_time() - began
    decoders = [load_decoder(run, seed) for seed in range(SEEDS)]
    return _driven(asked, model, TABLE, task, decoders, asked.drives, TIME_LIMIT_S) | {"train_s": train_s}


def _episodes(model: str, asked: argparse.Namespace, dataset: Dataset, fold: Fold) -> Drives:
    """A fold's held-out episodes, with a decoder that was trained without them."""
    robot = load_recorded_robot(dataset.demonstrations)
    fitted = fit_model(
        model,
        select_episodes(dataset.demonstrations, (*fold.training, *fold.validation)),
        validation=range(len(fold.training), len(fold.training) + len(fold.validation)),
        fit={"chain": robot.chain},
        state_noise_rad=STATE_NOISE_RAD,
        seeds=1,
        seed=asked.seed,
    )
    task = Replay(robot, routes_of(robot, select_episodes(dataset.demonstrations, fold.held_out)))
    return _driven(asked, model, f"fold {fold.index}", task, [fitted.decoder(0)], 1, HELD_OUT_LIMIT_S)


def _driven(
    asked: argparse.Namespace,
    model: str,
    place: str,
    task: Task,
    decoders: Sequence[Decoder],
    each: int,
    limit_s: float,
) -> Drives:
    """Every person's drives to each goal, decoders in turn."""
    drives: list[dict[str, object]] = []
    for person in asked.people:
        setups = [Setup(task, LatentController(one), None, PEOPLE[person], limit_s) for one in decoders]
        traces = drive_all(setups, each, asked.seed, asked.jobs)
        drives += [_entry(f"{place} {n}", person, trace, limit_s) for n, trace in enumerate(traces)]
        done = sum(trace.figures.success for trace in traces)
        mean_s = np.mean([trace.figures.time_s for trace in traces])
        print(f"{model}, {place}, {person}: {done} of {len(traces)}, {mean_s:.1f} s", flush=True)
    return {"model": model, "seed": asked.seed, "drives": drives}


def _entry(start: str, person: str, trace: Trace, limit_s: float) -> dict[str, object]:
    done = trace.figures.success
    return {
        "start": start,
        "person": person,
        "success": done,
        "time_s": trace.figures.time_s if done else limit_s,
        "ended_because": trace.ending.reason,
        "waypoints_reached": trace.progress,
    }


def _candidate(
    model: str, places: Sequence[Drives], starts: dict[str, int], people: Sequence[str]
) -> Candidate:
    """A model with its drives; where it has not driven yet, every drive succeeds, in no time."""
    drives = {(one["start"], one["person"]): one for of in places for one in of["drives"]}
    tables: dict[str, list[list[float]]] = {"success": [], "time_s": []}
    for place, count in starts.items():
        for start in range(count):
            of = [drives.get((f"{place} {start}", person), {}) for person in people]
            tables["success"].append([one.get("success", True) for one in of])
            tables["time_s"].append([one.get("time_s", 0.0) for one in of])
    return Candidate(
        KINDS[model],
        success=np.array(tables["success"], dtype=bool),
        time_s=np.array(tables["time_s"]),
        train_s=places[0]["train_s"],
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    seeing = [name for name, kind in KINDS.items() if kind.sees_context]
    parser.add_argument("--models", nargs="+", default=seeing, choices=seeing)
    parser.add_argument("--people", nargs="+", default=list(PEOPLE), choices=list(PEOPLE))
    parser.add_argument("--recording", type=Path, help="an imported dataset, such as of panda_pour_coffee")
    parser.add_argument("--drives", type=int, default=7, help="to each goal of the table")
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=-1)
    parser.add_argument("--out", type=Path, default=Path("default_model"))
    main(parser.parse_args())
