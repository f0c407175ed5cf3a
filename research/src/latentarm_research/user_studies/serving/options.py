"""The options of a served study, and the text that people consent to."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from sqlalchemy import URL

from latentarm.web.server.config import TeleopConfig
from latentarm.web.words.catalogue import Words
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.serving.kept_options import KeptOptions
from latentarm_research.user_studies.serving.words.catalogue import study_languages
from latentarm_research.user_studies.sizes import PRESETS, Sizes

PAGES: Final = Path(__file__).parent / "pages"


@final
@dataclass(frozen=True)
class Serving:
    """A study to serve."""

    definition: Definition
    kept: KeptOptions  # those that every start of it has in common
    config: TeleopConfig  # address, certificate, and the folder of the study
    information: str  # the text that people consent to, Markdown
    at_once: int  # how many people may drive at the same time
    database: Path | URL  # a file, or PostgreSQL, with the password where one was given

    @property
    def out(self) -> Path:
        """The folder of the study."""
        return self.config.spec.out

    @property
    def sizes(self) -> Sizes:
        """The sizes of its preset."""
        return PRESETS[self.kept.preset]

    @property
    def words(self) -> Words:
        """The texts of its pages."""
        return study_languages()[self.kept.language]


def general_information(definition: Definition, away_hours: float, words: Words) -> str:
    """The text that people consent to where the experimenter has written none, Markdown."""
    met = 1 if definition.design == "between" else len(definition.conditions)
    return words.say(
        "study.information",
        {
            "ways": words.say("study.ways", {"count": met}),
            "leave": words.say("study.leave.title"),
            "hours": f"{away_hours:g}",
        },
    )
