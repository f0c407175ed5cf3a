"""Drives with models that look at things, whose places come from sources: true, faulty, tags and touch.

Things stand where no demonstration had them, see `latentarm_research.studies.tasks.moved`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, cast, final

import numpy as np

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.untrusted.documents import read_object
from latentarm.models.decoder import Decoder
from latentarm.runs.results_folder import write_json
from latentarm.surroundings.catalogue import TOUCH as BY_TOUCH
from latentarm.tasks.place import Place
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec
from latentarm.web.arm_process.help import Help
from latentarm.web.arm_process.task_run import things_to_do
from latentarm_research.measurements import catalogue
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.simulated_page import UNSAFE, SimulatedPage
from latentarm_research.measurements.thing_sources import SOURCES, TRUE
from latentarm_research.studies.streams import generator
from latentarm_research.studies.study import Grid, Keep, Request
from latentarm_research.studies.tasks import kept
from latentarm_research.studies.tasks.cell import ModelCell, ShownCell, show, train, training_set
from latentarm_research.studies.tasks.moved import task_of
from latentarm_research.studies.tasks.preset import Condition, Preset, Stream
from latentarm_research.studies.tasks.runs import choice_of, decoders_of

MODEL: Final = Condition("joints objects_in_tool", "homogeneous", way_back=True)


def measure(options: catalogue.Surroundings, work: Work) -> Outcome:
    """Count the drives that succeed with each source, and the ticks in which anything is unsafe."""
    preset = Preset(
        "surroundings", options.runs, demonstrations=options.demonstrations, seeds=1, epochs=options.epochs
    )
    quiet = not work.bars
    grid = Grid(Request(work.out, preset, seed=work.seed, jobs=work.jobs, bars=work.bars, quiet=quiet))
    decoders: dict[str, Decoder] = {}
    for task in options.tasks:
        cells = [ShownCell(task, Stream.DEMONSTRATIONS, n, work.seed) for n in range(preset.demonstrations)]
        shown = grid.run("Demonstrations", show, cells, str, kept.KEEP_SHOWN)
        model = ModelCell(task, MODEL, training_set(task, shown), preset, work.seed)
        (trained,) = grid.run("Models", train, [model], lambda cell: cell.task, kept.KEEP_MODELS)
        (decoders[task],) = decoders_of(trained.model)
    drives = [
        DriveCell(task, source, number, work.seed, decoders[task])
        for number in range(options.runs)
        for task in options.tasks
        for source in options.sources or SOURCES
    ]
    found = grid.run("Drives", drive, drives, lambda cell: cell.label, KEEP)
    rows, broken = [], list[str]()
    for task, source in dict.fromkeys((one.task, one.source) for one in drives):
        mine = [f for one, f in zip(drives, found, strict=True) if (one.task, one.source) == (task, source)]
        done_s = [one["time_s"] for one in mine if one["success"]]
        figures: dict[str, float | None] = {
            "succeeded": sum(one["success"] for one in mine),
            "median_time_s": float(np.median(done_s)) if done_s else None,
            "in_straight_lines_percent": 100.0 * float(np.mean([one["straight_share"] for one in mine])),
            "stops": sum(one["stops"] for one in mine),
            "nearest_mm": 1000.0 * min(one["nearest_m"] for one in mine),
            "most_table_force_n": max(one["table_force_n"] for one in mine),
            **{name: sum(one[name] for one in mine) for name in UNSAFE},
        }
        rows += line("surroundings", source, len(mine), figures, task)
        broken += [f"{task}, {source}: {name} in {figures[name]:g} ticks" for name in UNSAFE if figures[name]]
    return Outcome(rows, broken)


@final
@dataclass(frozen=True, eq=False)
class DriveCell:
    """One drive with a source of `SOURCES`."""

    task: str
    source: str
    number: int
    seed: int
    decoder: Decoder

    @property
    def label(self) -> str:
        """Its name in errors, and of its file."""
        return f"{self.task}/{self.source}/{self.number}"


KEEP: Final = Keep[DriveCell, Mapping[str, float]](
    path=lambda out, cell: out / "runs" / f"{cell.label}.json",
    read=lambda path, cell: cast(dict[str, float], read_object(path)),
    write=lambda path, cell, figures: write_json(path, figures),
)


def drive(cell: DriveCell) -> Mapping[str, float]:
    """Drive once; the figures of the drive."""
    task = task_of(cell.task, Stream.RUNS)
    choice = choice_of(task, cell.number)
    begun, theirs = (
        task.begin(choice, generator(cell.seed, cell.task, Stream.RUNS, cell.number)) for _ in range(2)
    )
    latent, straight = LatentController(cell.decoder), EndEffectorController(task.robot)
    setup = DriveSetup(
        spec=Spec(objects=() if cell.source == TRUE else (BY_TOUCH,), incidents=False),
        arm="mujoco",
        task=Place(task.robot, begun.goals, task.obstacles, begun.objects),
        controller=JoinedController([latent, straight]),
        latent_dim=latent.input_dim,
        axes=straight.modes,
        help=Help(),
        start=begun.state,
        todo=things_to_do(task, choice, begun),
        scene=begun.scene,
    )
    controllers = {"latent": latent, "end_effector": straight}
    rng = generator(cell.seed, cell.task, 3, cell.number)
    page = SimulatedPage(setup, cell.source, theirs, controllers, rng)
    page.run(task.time_limit_s)
    return page.figures(choice)
