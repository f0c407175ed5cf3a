"""`latentarm align`: a person's alignment, from their answers."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from tyro.conf import Positional, arg

from latentarm.alignment.preference import AXES, ToolAxes
from latentarm.alignment.queries import StoppingRule
from latentarm.commands.configuration import write_options
from latentarm.commands.output import say, show
from latentarm.core.types import Row
from latentarm.runs.asking import FASTEST, PersonAtTerminal, SimulatedRespondent
from latentarm.runs.checks import check_count, check_seed
from latentarm.runs.options import Json, MovedDataset, Seed
from latentarm.runs.person import Kind, Respondent, Say
from latentarm.runs.stick_line import read_line

if TYPE_CHECKING:
    from latentarm.alignment.judgement import Judgement
    from latentarm.runs.questions import AlignmentProblem


@dataclass(frozen=True)
class AlignOptions:
    """Options of `latentarm align`.

    Raises UserError where a figure is out of its range.
    """

    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")]
    name: Annotated[str, arg(metavar="NAME", help="The person's name, as given to `drive --profile`.")]
    answers: Annotated[int, arg(help="Ask at most this many questions.")] = 10
    seed_index: Annotated[int, arg(help="Which of the run's seeds decodes, from 0.")] = 0
    simulated: Annotated[
        bool, arg(help="Let a simulated person answer, for whom the stick's axes are those of the base.")
    ] = False
    demonstrations: MovedDataset = None
    seed: Seed = 0
    json: Json = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_count("answers", self.answers)


def align_run(config: AlignOptions, say: Say) -> list[Row]:
    """Ask, learn, and write the profile to ``profiles/<name>`` of the run. Nothing is written before the end.

    Returns the error on the answers themselves: with the profile, and with z = u.

    Raises UserError where the run cannot be aligned, the name is taken, or nobody answers.
    """
    from latentarm.alignment.profile import new_profile_folder
    from latentarm.runs.aligning import alignable, learn
    from latentarm.runs.questions import ask

    folder = new_profile_folder(config.run, config.name)
    known = alignable(config.run, config.seed_index, config.seed, config.demonstrations)
    person = _person(config, known.scene, say)
    answers = ask(known.scene, person, config.answers, say, StoppingRule())
    say(f"Learning from {len(answers)} answers of a {person.kind} ...")
    learned = learn(known, answers, config.name, person.kind)
    learned.save(folder)
    say(_judged(learned.judgement, person.kind))
    return learned.rows


def _judged(judgement: "Judgement", kind: Kind) -> str:
    """How good the profile is, for the person."""
    from latentarm.web.protocol.notice import Notice

    if judgement.refusal is None:
        errors = f"{judgement.learned:.0%} of standing still, and {judgement.present:.0%} with z = u"
        return f"The {kind}'s profile misses answers that it was not learned from by {errors}."
    return f"The page would not keep this {kind}'s profile. {Notice(code=judgement.refusal).text}"


def _person(config: AlignOptions, scene: "AlignmentProblem", say: Say) -> Respondent:
    """The person to ask."""
    if not config.simulated:
        return PersonAtTerminal(say, read_line)
    chain, motions, axes = scene.chain, scene.motions, scene.decoder.latent_dim
    moved = chain.forward(motions.end).position - chain.forward(motions.start).position
    speed = float(np.quantile(np.abs(moved[:, :axes]).max(axis=1), FASTEST)) / motions.duration_s
    preference = ToolAxes(chain, axes, speed)
    meant = ", ".join(f"axis {axis + 1} is {name}" for axis, name in enumerate(AXES[:axes]))
    say(f"A simulated person answers, for whom {meant} of the tool; a full push is {speed:.2f} m/s.")
    return SimulatedRespondent(preference, say)


def align(options: AlignOptions) -> int:
    """Ask what a person means by their input, and keep it as their profile (section 6 of the paper).

    Shows motions and asks for each how they would push the stick for it: numbers from -1 to 1, or arrow keys.
    For example: latentarm align runs/pour-cae --name ada
    """
    from latentarm.alignment.profile import profile_folder

    run, name, json = options.run, options.name, options.json
    try:
        rows = align_run(options, lambda sentence: say(sentence, json))
    except KeyboardInterrupt:
        print("\nNothing is saved.", file=sys.stderr)
        raise
    write_options(profile_folder(run, name), "align")
    show(rows, json)
    whose = "simulated person's profile" if options.simulated else "profile"
    say(f"The {whose} is {run}/profiles/{name}/; next: latentarm drive {run} --profile {name}", json)
    return 0
