"""Drives every candidate for the default model, and applies the rule of docs/decisions/0031 to the drives.

The demo's table and, with a recording, its held-out episodes; each with all simulated people. For example:
python scripts/default_model.py --models cvae scl homogeneous --recording pour --out default_model
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter

import numpy as np

from latentarm.commands.demo import TIME_LIMIT_S, USUAL
from latentarm.commands.drive import HELD_OUT_LIMIT_S
from latentarm.controllers.latent import LatentController
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.split import select_episodes
from latentarm.models.catalogue import DEFAULT_MODEL, KINDS
from latentarm.models.kind import Decoder
from latentarm.models.saving import load_decoder
from latentarm.operators.catalogue import PEOPLE
from latentarm.robots.catalogue import load_recorded_robot
from latentarm.runs.training import TrainConfig, train_run
from latentarm.simulation.drive import STATE_NOISE_RAD, Setup, Trace
from latentarm.simulation.drives import drive_all
from latentarm.studies.compare.datasets import read_datasets
from latentarm.studies.default_model import Candidate, choose
from latentarm.studies.fitting import fit_model
from latentarm.tasks.replay import Replay, routes_of
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task

Place = tuple[str, Task, list[Decoder], int, float]
"""Name, task, decoders that take turns, drives to each goal, limit in s."""


def main(asked: argparse.Namespace) -> None:
    """Train, drive, write every drive, and say what the rule keeps at each step."""
    asked.out.mkdir(parents=True, exist_ok=True)
    found: list[Candidate] = []
    for model in asked.models:
        path = asked.out / f"{model}.json"
        if not path.exists():
            path.write_text(json.dumps(_driven(model, asked), indent=1))
        drives = json.loads(path.read_text())
        found.append(_candidate(model, drives, asked.people))
    for step in choose(found):
        print(f"\n{step.rule}: {', '.join(step.kept)}")
        for name, figure in step.figures.items():
            print(f"  {name:<16} {figure}")
    print(f"\nThe default now is {DEFAULT_MODEL}.")


def _driven(model: str, asked: argparse.Namespace) -> dict[str, object]:
    """Training time, and every drive of one model."""
    drives: list[dict[str, object]] = []
    began = perf_counter()
    places = list(_table(model, asked))
    train_s = perf_counter() - began
    if asked.recording is not None:
        places += _episodes(model, asked)
    for name, task, decoders, each, limit_s in places:
        for person in asked.people:
            setups = [Setup(task, LatentController(one), None, PEOPLE[person], limit_s) for one in decoders]
            traces = drive_all(setups, each, asked.seed, asked.jobs)
            drives += [_entry(f"{name} {n}", person, trace, limit_s) for n, trace in enumerate(traces)]
            done = sum(trace.figures.success for trace in traces)
            mean_s = np.mean([trace.figures.time_s for trace in traces])
            print(f"{model}, {name}, {person}: {done} of {len(traces)}, {mean_s:.1f} s", flush=True)
    return {"model": model, "seed": asked.seed, "train_s": train_s, "drives": drives}


def _table(model: str, asked: argparse.Namespace) -> Iterator[Place]:
    """The demo's table, with decoders trained as there."""
    shown, run = asked.out / "table", asked.out / "runs" / model
    task = TableTop()
    if not shown.exists():
        write_dataset(task.demonstrate(USUAL.episodes, np.random.default_rng(asked.seed)), shown)
    train_run(
        TrainConfig(
            demonstrations=shown,
            model=model,
            out=run,
            seeds=USUAL.seeds,
            seed=asked.seed,
            state_noise_rad=STATE_NOISE_RAD,
            epochs=USUAL.epochs,
        )
    )
    yield "table", task, [load_decoder(run, seed) for seed in range(USUAL.seeds)], asked.drives, TIME_LIMIT_S


def _episodes(model: str, asked: argparse.Namespace) -> Iterator[Place]:
    """Every episode of a recording, with a decoder that was trained without it."""
    dataset = read_datasets([asked.recording], asked.folds, asked.seed)[0]
    robot = load_recorded_robot(dataset.demonstrations)
    for fold in dataset.folds:
        learned = select_episodes(dataset.demonstrations, (*fold.training, *fold.validation))
        fitted = fit_model(
            model,
            learned,
            validation=range(len(fold.training), len(fold.training) + len(fold.validation)),
            fit={"chain": robot.chain},
            state_noise_rad=STATE_NOISE_RAD,
            seeds=1,
            seed=asked.seed,
        )
        held_out = select_episodes(dataset.demonstrations, fold.held_out)
        task = Replay(robot, routes_of(robot, held_out))
        yield f"fold {fold.index}", task, [fitted.decoder(0)], 1, HELD_OUT_LIMIT_S


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


def _candidate(model: str, driven: dict[str, object], people: Sequence[str]) -> Candidate:
    drives = {(one["start"], one["person"]): one for one in driven["drives"]}
    starts = list(dict.fromkeys(start for start, _ in drives))
    table = [[drives[start, person] for person in people] for start in starts]
    return Candidate(
        KINDS[model],
        success=np.array([[one["success"] for one in row] for row in table]),
        time_s=np.array([[one["time_s"] for one in row] for row in table]),
        train_s=driven["train_s"],
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
