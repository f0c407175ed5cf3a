"""How commands are told which study."""

from typing import Annotated

from tyro.conf import arg

from latentarm_research.user_studies.catalogue import NAMES

StudyName = Annotated[
    str,
    arg(
        metavar="{" + ",".join(NAMES) + ",FILE.json}",
        help="The study, or a JSON file with the definition of one of your own.",
    ),
]
