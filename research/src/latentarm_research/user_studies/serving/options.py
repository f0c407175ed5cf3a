"""The options of a served study, and the text that people consent to."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from latentarm.web.server.config import TeleopConfig
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.sizes import Sizes

PAGES: Final = Path(__file__).parent / "pages"


@final
@dataclass(frozen=True)
class Serving:
    """A study to serve."""

    definition: Definition
    sizes: Sizes
    seed: int  # of orders, scenes and items
    config: TeleopConfig  # address, certificate, and the folder of the study
    information: str  # the text that people consent to, Markdown
    at_once: int  # how many people may drive at the same time
    prolific: str | None  # the study at the recruiting site whose links count; None for none
    completion: str | None  # the code that everybody gets; None for one of their own
    away_s: float  # a person who opens no page for so long loses their place, s
    database: str | None  # URL of PostgreSQL; None for a file in the folder

    @property
    def out(self) -> Path:
        """The folder of the study."""
        return self.config.spec.out

    @property
    def digest(self) -> str:
        """SHA-256 of the information, in hexadecimal."""
        return hashlib.sha256(self.information.encode()).hexdigest()


def general_information(definition: Definition, away_hours: float) -> str:
    """The text that people consent to where the experimenter has written none."""
    # Markdown, not HTML: its own renderer escapes what is no Markdown.
    texts = Environment(loader=FileSystemLoader(PAGES), undefined=StrictUndefined, trim_blocks=True)  # noqa: S701
    met = 1 if definition.design == "between" else len(definition.conditions)
    template = texts.get_template("information.md")
    return template.render(definition=definition, conditions=met, hours=f"{away_hours:g}")
