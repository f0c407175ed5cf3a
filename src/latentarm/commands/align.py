"""`latentarm align`: a person's alignment, from their answers."""

import sys
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Json, MovedDataset, Seed
from latentarm.commands.output import say, show


def align(
    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")],
    name: Annotated[str, arg(metavar="NAME", help="Of the person; `drive --profile` takes it.")],
    answers: Annotated[int, arg(help="Questions to be answered, at most.")] = 10,
    seed_index: Annotated[int, arg(help="Which of the run's seeds decodes, from 0.")] = 0,
    simulated: Annotated[
        bool, arg(help="Let a simulated person answer, for whom the stick's axes are those of the base.")
    ] = False,
    demonstrations: MovedDataset = None,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Ask what a person means by their input, and keep it as their profile (section 6 of the paper).

    Shows motions and asks for each how they would push the stick for it: numbers from -1 to 1, or arrow keys.
    For example: latentarm align runs/pour-cae --name ada
    """
    from latentarm.alignment.profile import profile_folder
    from latentarm.commands.aligning_body import AlignConfig, align_run

    config = AlignConfig(
        run=run,
        name=name,
        answers=answers,
        seed_index=seed_index,
        simulated=simulated,
        seed=seed,
        dataset=demonstrations,
        progress=not json and sys.stderr.isatty(),
    )
    try:
        rows = align_run(config, lambda sentence: say(sentence, json))
    except KeyboardInterrupt:
        print("\nNothing is saved.", file=sys.stderr)
        raise
    write_options(profile_folder(run, name), "align")
    show(rows, json)
    whose = "simulated person's profile" if simulated else "profile"
    say(f"The {whose} is {run}/profiles/{name}/; next: latentarm drive {run} --profile {name}", json)
    return 0
