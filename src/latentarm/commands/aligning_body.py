"""`latentarm align`: ask a person what they mean by their input, and keep the answer as their profile."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from latentarm.alignment.profile import new_profile_folder
from latentarm.alignment.queries import StoppingRule
from latentarm.alignment.training import step_bar
from latentarm.operators.preference import AXES, ToolAxes
from latentarm.runs.aligning import alignable, learn
from latentarm.runs.checks import check_count, check_seed
from latentarm.runs.person import Person, Say
from latentarm.runs.questions import Scene, ask
from latentarm.simulation.asking import FASTEST, PersonAtTerminal, SimulatedPerson
from latentarm.simulation.stick_line import read_line
from latentarm.types import Row


@dataclass(frozen=True)
class AlignConfig:
    """What `latentarm align` was asked for; its ``--help`` says the same of each field.

    Attributes:
        run: a trained run.
        name: of the person.
        answers: questions to be answered, at most.
        seed_index: which of the run's seeds decodes.
        simulated: let a simulated person answer.
        seed: of everything random.
        dataset: where the run's dataset lies now, if it was moved.
        progress: show a bar on standard error.

    Raises:
        UserError: a figure is out of its range.
    """

    run: Path
    name: str
    answers: int = 10
    seed_index: int = 0
    simulated: bool = False
    seed: int = 0
    dataset: Path | None = None
    progress: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_count("answers", self.answers)


def align_run(config: AlignConfig, say: Say) -> list[Row]:
    """Ask, learn, and write the profile to ``profiles/<name>`` of the run. Nothing is written before the end.

    Args:
        config: what is asked for.
        say: shows text to the person.

    Returns:
        How far the answers themselves are missed: with the profile, with an affine map, and with z = u.

    Raises:
        UserError: the run cannot be aligned, the name is taken, or nobody answers.
    """
    folder = new_profile_folder(config.run, config.name)
    known = alignable(
        config.run, config.seed_index, config.seed, config.dataset, lambda: step_bar(config.progress)
    )
    person = _person(config, known.scene, say)
    answers = ask(known.scene, person, config.answers, say, StoppingRule())
    say(f"Learning from {len(answers)} answers of a {person.kind} ...")
    learned = learn(known, answers, config.name, person.kind)
    learned.save(folder)
    return learned.rows


def _person(config: AlignConfig, scene: Scene, say: Say) -> Person:
    """Whom to ask."""
    if not config.simulated:
        return PersonAtTerminal(say, read_line)
    chain, motions, axes = scene.chain, scene.motions, scene.model.latent_dim
    moved = chain.forward(motions.end).position - chain.forward(motions.start).position
    speed = float(np.quantile(np.abs(moved[:, :axes]).max(axis=1), FASTEST)) / motions.duration_s
    preference = ToolAxes(chain, axes, speed)
    meant = ", ".join(f"axis {axis + 1} is {name}" for axis, name in enumerate(AXES[:axes]))
    say(f"A simulated person answers, for whom {meant} of the tool; a full push is {speed:.2f} m/s.")
    return SimulatedPerson(preference, say)
