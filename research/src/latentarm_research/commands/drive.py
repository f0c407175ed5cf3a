"""`latentarm drive`: simulated operators drive a task, with latent actions or with mode switching."""

from latentarm.commands.configuration import write_options
from latentarm.commands.output import note, say, show
from latentarm_research.commands.drive_options import DriveOptions


def drive(options: DriveOptions) -> int:
    """Drive an arm in simulation with a simulated operator, through Algorithm 1 and its safety filters.

    Exits with 1 when no drive reached its goal. For example: latentarm drive runs/pour-cae
    """
    from latentarm_research.commands.drive_run import drive_run
    from latentarm_research.drives.drive_table import endings_in_words

    driven = drive_run(options, note)
    write_options(
        options.out,
        "drive",
        controller=driven.controller,
        operator=driven.operator,
        task=driven.task,
        time_limit_s=driven.time_limit_s,
    )
    show(driven.rows, options.json)
    for sentence in endings_in_words(driven.entries):
        say(sentence, options.json)
    say(
        f"One row per drive is in {options.out}/drives.csv; drives.json and paths.png are next to it.",
        options.json,
    )
    return 0 if any(entry["success"] for entry in driven.entries) else 1
