"""Draw ``docs/figures/tasks/<task>.png``: each task with things by latent actions, as a strip of 8 pictures.

``python scripts/film_strips.py dessert --study reproduced/tasks`` draws that of one task with the models of
that folder, which ``latentarm reproduce tasks`` wrote; without a folder it trains the same models itself. The
strip shows the first of the study's runs that succeeds, and says which that is.
"""

import argparse
import os
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")  # before MuJoCo is imported

from latentarm.core.errors import UserError
from latentarm.core.figure_style import save_figure
from latentarm.core.parallel import run_grid
from latentarm.core.untrusted.documents import read_object
from latentarm.evaluation.looks import look_of
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm.models.saving import read_model
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm_research.drives.drive import Setup, drive
from latentarm_research.drives.film import Camera, Film, strip
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.streams import generator
from latentarm_research.studies.tasks.cell import ModelCell, ShownCell, show, train, training_set
from latentarm_research.studies.tasks.kept import MODELS
from latentarm_research.studies.tasks.preset import PRESETS, Condition, Preset, Stream
from latentarm_research.studies.tasks.rows import STUDY
from latentarm_research.studies.tasks.runs import Driver, choice_of, decoders_of, kept_in

FIGURES = Path(__file__).resolve().parents[1] / "docs" / "figures" / "tasks"

COUNTER = Camera(look_at=(0.45, 0.0, 0.33), distance_m=0.8, azimuth_deg=165.0, elevation_deg=-42.0)
"""For what stands on the counter, higher and farther apart than plates."""

CAMERAS: dict[str, Camera] = dict.fromkeys(("avoid", "pour", "reach_and_pour", "apple_pie"), COUNTER)
"""Of tasks that the usual one does not show well."""


def learned(task: str, model: str, preset: Preset, seed: int, jobs: int) -> Driver:
    """The models of the study, trained anew."""
    cells = [ShownCell(task, Stream.DEMONSTRATIONS, number, seed) for number in range(preset.demonstrations)]
    shown = run_grid(show, cells, jobs=jobs, label=lambda cell: task, bars=True)
    condition = Condition(preset.context, model, way_back=True)
    return train(ModelCell(task, condition, training_set(task, shown), preset, seed)).driver


def sizes_of(study: Path) -> tuple[Preset, int]:
    """The sizes and the seed of a study that was run.

    Raises:
        UserError: the folder holds no such study.
    """
    config = read_object(study / CONFIG)
    # Its rows are written last: what lies in the folder of a run that was cut short may be an earlier one's.
    if config.get("study") != STUDY or not (study / "results.json").is_file():
        raise UserError(f"{study} holds no whole `latentarm reproduce tasks`: name a folder that it wrote.")
    return PRESETS[config["preset"]["name"]], config["seed"]


def kept(task: str, model: str, preset: Preset, study: Path) -> Driver:
    """The models that a study kept."""
    condition = Condition(preset.context, model, way_back=True)
    return Driver(condition, decoders_of(read_model(study / MODELS / kept_in(task, condition))))


def film(task: str, model: str, driver: Driver, preset: Preset, seed: int) -> None:
    """Drive until one run succeeds, and write its strip.

    Raises:
        UserError: none succeeds, or nothing can be rendered here.
    """
    made = make_scene_task(task)
    for number in range(preset.runs):
        watched = Film()
        setup = Setup(made, driver.controller(made.robot, number), PEOPLE[preset.people[0]])
        rng = generator(seed, task, Stream.RUNS, number)
        trace = drive(setup, choice_of(made, number), rng, watched.sees)
        print(
            f"{task}, run {number}: {trace.ending.detail} after {trace.figures.time_s:.1f} s {trace.ended_in}"
        )
        if trace.figures.success:
            times, pictures = watched.frames(CAMERAS.get(task, Camera()))
            heading = (
                f"{look_of(task).label} by latent actions ({look_of(model).label}); run {number} of seed"
                f" {seed}; person, arm and things simulated"
            )
            FIGURES.mkdir(parents=True, exist_ok=True)
            save_figure(strip(heading, times, pictures, trace), FIGURES / f"{task}.png")
            return
    raise UserError(f"None of {preset.runs} runs of {task} succeeded: there is no strip of it.")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tasks", nargs="*", default=[*SCENE_TASKS], help="all where none is named")
    parser.add_argument("--model", default=DEFAULT_MODEL)
    parser.add_argument("--study", type=Path, help="what `latentarm reproduce tasks` wrote; else train here")
    parser.add_argument("--seed", type=int, default=0, help="of the models that are trained here")
    parser.add_argument("--jobs", type=int, default=-1)
    given = parser.parse_args()
    sizes, number = (PRESETS["paper"], given.seed) if given.study is None else sizes_of(given.study)
    for chosen in given.tasks:
        if given.study is None:
            steered = learned(chosen, given.model, sizes, number, given.jobs)
        else:
            steered = kept(chosen, given.model, sizes, given.study)
        film(chosen, given.model, steered, sizes, number)
