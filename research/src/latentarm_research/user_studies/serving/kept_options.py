"""The options of a study's first start, which its folder keeps: every later start serves the same study."""

import hashlib
import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Final, final

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.bounds import MAX_TEXT_BYTES
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.user_studies.recorded import SERVED
from latentarm_research.user_studies.serving.words.catalogue import study_languages
from latentarm_research.user_studies.sizes import PRESETS

AWAY_HOURS: Final = 2.0
LANGUAGE: Final = "en"
LONGEST_CONTACT: Final = 200  # characters


@final
class KeptOptions(BaseModel):
    """Options of `latentarm study serve`, by their names there."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    key: str = Field(default_factory=lambda: secrets.token_hex(16))  # the study's; its database has it too
    contact: str | None = None  # whom participants can ask; None in folders of earlier versions
    language: Annotated[str, Field(pattern=f"^({'|'.join(study_languages())})$")] = LANGUAGE  # of its pages
    information: str  # SHA-256 of the text that people consent to, in hexadecimal
    prolific: str | None = None  # the study at Prolific whose links count; None for none
    completion_code: str | None = None  # that everybody gets; None for one of their own
    away_hours: float = AWAY_HOURS  # a person who opens no page for so long loses their place
    database: str | None = None  # URL of PostgreSQL without its password; None for a file in the folder
    preset: Annotated[str, Field(pattern=f"^({'|'.join(PRESETS)})$")] = "paper"
    seed: int = 0  # of orders, scenes and items


def read_kept(out: Path) -> KeptOptions | None:
    """The options that a folder keeps; None where nothing was served from it."""
    if not (out / CONFIG).exists():
        return None
    kept = read_object(out / CONFIG).get(SERVED)
    if kept is None:
        return None
    try:
        return KeptOptions.model_validate(kept)
    except ValidationError as error:
        wrong = error.errors()[0]["loc"]
        raise UserError(
            f"{out / CONFIG}: {'.'.join(map(str, (SERVED, *wrong)))} is not that of a served study:"
            " restore the file from a copy."
        ) from error


def go_on(
    out: Path, kept: KeptOptions | None, given: Mapping[str, object], say: Callable[[str], None]
) -> KeptOptions:
    """The options of a start: those given, and the kept ones for those left out (None), which it says.

    Raises a `UserError` where one differs from that kept, or nobody is named whom participants can ask.
    """
    chosen = {name: value for name, value in given.items() if value is not None}
    contact = str(chosen.get("contact", "" if kept is None else kept.contact or ""))
    if not (contact.strip() and contact.isprintable() and len(contact) <= LONGEST_CONTACT):
        raise UserError(
            "Name with --contact whom participants can ask, on one line of at most"
            f' {LONGEST_CONTACT} characters, such as "Ann Lee, ann@uni.example".'
        )
    if kept is None:
        return KeptOptions.model_validate(chosen)
    if kept.contact is None:
        kept = kept.model_copy(update={"contact": contact})
    before = kept.model_dump()
    for name, value in chosen.items():
        if value != before[name]:
            raise UserError(
                f"The study in {out} began {_option_words(name, before[name])}, and this start is"
                f" {_option_words(name, value)}: begin it as before, or choose another folder with --out."
            )
    usual = {name: field.default for name, field in KeptOptions.model_fields.items()}
    left_out = [name for name in given if name not in chosen and before[name] != usual[name]]
    if left_out:
        say(f"As at the first start: {', '.join(_option_words(name, before[name]) for name in left_out)}.")
    return kept


def _option_words(name: str, value: object) -> str:
    option = f"--{name.replace('_', '-')}"
    if name == "information":
        return f"with {option} of SHA-256 {str(value)[:12]}"
    return f"without {option}" if value is None else f"with {option} {value}"


def digest_of(information: str) -> str:
    """SHA-256 of a text that people consent to, in hexadecimal."""
    return hashlib.sha256(information.encode()).hexdigest()


def information_path(out: Path, digest: str) -> Path:
    """The file in which a folder keeps this text."""
    return out / f"information-{digest[:12]}.md"


def read_information(path: Path) -> str:
    """The text in a file."""
    return read_bytes(path, MAX_TEXT_BYTES).decode("utf-8", "replace")
