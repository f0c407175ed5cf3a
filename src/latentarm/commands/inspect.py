"""`latentarm inspect`: what a dataset holds."""

from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Json
from latentarm.commands.output import note, say, show


def inspect(
    dataset: Annotated[Positional[Path], arg(metavar="DST", help="Folder of a native dataset.")],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for the figure; beside the dataset by default.")
    ] = None,
    json: Json = False,
) -> int:
    """Show a dataset: episodes, rates, ranges, and a figure of the joints.

    For example: latentarm inspect pour
    """
    from latentarm.commands.inspection_body import draw, summary, summary_tables, why_unknown
    from latentarm.demonstrations.dataset import read_dataset

    demonstrations = read_dataset(dataset)
    unknown = why_unknown(demonstrations, str(dataset))
    if unknown:
        note([unknown])
    figure = draw(demonstrations, out or dataset.with_name(f"{dataset.name}-figures"))
    write_options(figure.parent, "inspect")
    show(summary(demonstrations).rows(), json, *summary_tables(demonstrations))
    say(f"The joints over time are drawn in {figure}.", json)
    return 0
