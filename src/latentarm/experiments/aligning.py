"""`latentarm align`: ask a person what they mean by their input, and keep the answer as their profile."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.alignment.affine import fit_affine
from latentarm.alignment.contract import identity
from latentarm.alignment.error import relative_alignment_error
from latentarm.alignment.profile import Profile, model_fingerprint, new_profile_folder, save_profile
from latentarm.alignment.queries import StoppingRule
from latentarm.alignment.training import FitConfig
from latentarm.demonstrations.split import select_episodes
from latentarm.errors import UserError
from latentarm.experiments.asking import Person, PersonAtTerminal, Say, SimulatedPerson
from latentarm.experiments.checks import check_count, check_seed
from latentarm.experiments.questions import ENSEMBLE, Scene, ask, shown
from latentarm.experiments.stick_line import read_line
from latentarm.experiments.training import prepared
from latentarm.metrics.results import as_document
from latentarm.metrics.summary import unit_of
from latentarm.models.catalogue import load_model
from latentarm.operators.preference import AXES, ToolAxes
from latentarm.runs.folder import read_run, robot_of
from latentarm.types import Row

ALIGN_STREAM: Final = 3
"""Keeps these draws apart from everything else that is drawn from the same seed."""

FASTEST: Final = 0.99
"""Share of the motions that the simulated person can ask for without pushing beyond 1."""


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
    run = read_run(config.run)
    model = load_model(config.run)
    fingerprint = model_fingerprint(config.run, config.seed_index)
    chain = robot_of(run).chain
    decoder = model.decoder(config.seed_index)
    if decoder.action_dim != chain.dof:
        raise UserError(
            f"{config.run} was trained for {decoder.action_dim} joints; its robot has {chain.dof}."
        )
    rng = np.random.default_rng([ALIGN_STREAM, config.seed])
    demonstrations = prepared(run.dataset(config.dataset), run.context)
    training = np.setdiff1d(np.arange(len(demonstrations.episodes)), run.held_out)
    context = "state_belief" if run.context == "state_belief" else "state"
    motions, unlabelled = shown(select_episodes(demonstrations, training), context, chain, rng)
    scene = Scene(model, config.seed_index, chain, motions, unlabelled, rng, config.progress)
    person = _person(config, scene, say)
    answers = ask(scene, person, config.answers, say, StoppingRule())
    say(f"Learning from {len(answers)} answers of a {person.kind} ...")
    alignment = scene.learn([answers] * ENSEMBLE, FitConfig()).best
    alignments = {
        "no_align": identity,
        "manual_align": fit_affine(model, answers, config.seed_index),
        "profile": alignment,
    }
    rows = [
        Row(
            study="align",
            measure="relative_alignment_error",
            unit=unit_of("relative_alignment_error"),
            mean=relative_alignment_error(one, decoder, chain, answers),
            sd=None,
            n=1,
            model=run.model,
            condition=f"{name}, simulated" if config.simulated else name,
        )
        for name, one in alignments.items()
    ]
    about = {
        "name": config.name,
        "person": person.kind,
        "seed": config.seed,
        "answers": {
            "duration_s": answers.motions.duration_s,
            "start": answers.motions.start.tolist(),
            "end": answers.motions.end.tolist(),
            "belief": answers.motions.belief.tolist(),
            "u": answers.u.tolist(),
        },
        **as_document(rows),
    }
    save_profile(Profile(alignment, fingerprint, config.seed_index), folder, about)
    return rows


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
