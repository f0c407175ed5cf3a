"""A person's alignment with a run: the questions, and learning from the answers."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import Alignment, identity
from latentarm.alignment.demonstrated import shown
from latentarm.alignment.error import relative_alignment_error
from latentarm.alignment.judgement import Judgement, judge
from latentarm.alignment.profile import model_fingerprint, save_profile
from latentarm.alignment.tool_space import ToolSpace
from latentarm.assistance.annotation import prepared
from latentarm.core.errors import UserError
from latentarm.core.types import Row
from latentarm.demonstrations.split import select_episodes
from latentarm.evaluation.measures import unit_of
from latentarm.evaluation.results import as_document
from latentarm.models.decoder import Decoder
from latentarm.models.saving import read_model
from latentarm.runs.folder import Run, read_run, robot_of
from latentarm.runs.person import Kind
from latentarm.runs.questions import AlignmentProblem
from latentarm.runs.samples import ALIGN_STREAM, load_samples

NO_ALIGN: Final = "no_align"
PROFILE: Final = "profile"  # conditions of the rows: z = u, and the learned alignment


@final
@dataclass(frozen=True, eq=False)
class Alignable:
    """A run, ready for a person's questions."""

    run: Run
    fingerprint: str  # of the model and the seed that decodes
    seed_index: int
    scene: AlignmentProblem
    seed: int


@final
@dataclass(frozen=True, eq=False)
class LearnedProfile:
    """A learned alignment of a person."""

    known: ToolSpace
    fingerprint: str  # of the model and the seed that it is for
    seed_index: int
    rows: list[Row]  # error on the answers themselves: with the profile, and with z = u
    judgement: Judgement  # of it beside the directions that the person had
    about: dict[str, object]  # further keys of the profile's file

    def save(self, folder: Path) -> None:
        """Write the profile to a new folder, whole or not at all; UserError where that is impossible."""
        save_profile(self.known, self.fingerprint, self.seed_index, folder, self.about)


def alignable(folder: Path, seed_index: int = 0, seed: int = 0, dataset: Path | None = None) -> Alignable:
    """Load a run, and choose the motions that may be asked about.

    ``dataset`` is where the run's dataset lies now, if it was moved; runs of this version do not need it.

    Raises UserError where the run cannot be aligned.
    """
    run = read_run(folder)
    trained = read_model(folder)
    fingerprint = model_fingerprint(folder, seed_index)
    chain = robot_of(run).chain
    decoder = Decoder(trained, seed_index)
    if decoder.action_dim != chain.dof:
        raise UserError(f"{folder} was trained for {decoder.action_dim} joints; its robot has {chain.dof}.")
    rng = np.random.default_rng([ALIGN_STREAM, seed])
    samples = load_samples(folder)
    if samples is not None and samples.motions is not None:
        motions = samples.motions
    else:
        demonstrations = prepared(run.dataset(dataset, "motions to ask about"), run.context)
        training = np.setdiff1d(np.arange(len(demonstrations.episodes)), run.held_out)
        motions = shown(select_episodes(demonstrations, training), decoder.layout.features, chain, rng)
    scene = AlignmentProblem(decoder, chain, motions)
    return Alignable(run, fingerprint, seed_index, scene, seed)


def learn(
    known: Alignable, answers: Answers, name: str, kind: Kind, present: Alignment = identity
) -> LearnedProfile:
    """Learn a person's alignment from their answers, and judge it beside the present one."""
    scene, decoder = known.scene, known.scene.decoder
    tool_space = scene.learn(answers)
    judgement = judge(
        answers,
        lambda some: scene.learn(some).with_arm(decoder, scene.chain),
        present,
        decoder,
        scene.chain,
        scene.candidates,
    )
    alignments = {
        NO_ALIGN: identity,
        PROFILE: tool_space.with_arm(decoder, scene.chain),
    }
    rows = [
        Row(
            study="align",
            measure="relative_alignment_error",
            unit=unit_of("relative_alignment_error"),
            mean=relative_alignment_error(one, decoder, scene.chain, answers),
            sd=None,
            n=1,
            model=known.run.model,
            condition=condition if kind == "person" else f"{condition}, simulated",
        )
        for condition, one in alignments.items()
    ]
    about: dict[str, object] = {
        "name": name,
        "person": kind,
        "seed": known.seed,
        "answers": {
            "duration_s": answers.motions.duration_s,
            "start": answers.motions.start.tolist(),
            "end": answers.motions.end.tolist(),
            "rest": answers.motions.rest.tolist(),
            "u": answers.u.tolist(),
        },
        "judgement": asdict(judgement),
        **as_document(rows),
    }
    return LearnedProfile(tool_space, known.fingerprint, known.seed_index, rows, judgement, about)
