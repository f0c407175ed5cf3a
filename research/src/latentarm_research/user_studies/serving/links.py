"""The links that open a study: ours with a code, and those of the recruiting site Prolific."""

import logging
from typing import Final

from starlette.datastructures import QueryParams

from latentarm.core.errors import UserError

SITE_IDS: Final = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")  # that Prolific adds to its link

_MOST: Final = 64  # characters of a code or id in a link, at most
_LOG: Final = logging.getLogger(__name__)


def link_of(given: QueryParams, prolific: str | None) -> tuple[str, str]:
    """Code of a link of ours, or the person and visit of a link of Prolific; "" for none.

    Raises a `UserError`, for the participant, where a link of Prolific cannot be used.
    """
    if "code" in given or not any(name in given for name in SITE_IDS):
        return given.get("code", "")[:_MOST], ""
    for name in SITE_IDS:
        if wrong := _wrong(name, given.get(name, ""), prolific):
            # No value: they are people's.
            _LOG.warning("A link of Prolific was refused: %s.", wrong)
            raise UserError(
                f"The link from Prolific cannot be used: {wrong}. Open the study at Prolific again. If that"
                " does not help, send the researchers a message there, with this sentence."
            )
    return given["PROLIFIC_PID"], given["SESSION_ID"]


def _wrong(name: str, value: str, prolific: str | None) -> str:
    """The fault of an id in a link, "" for none."""
    if prolific is None:
        return "this study does not take people from Prolific"
    if not value:
        return f"it lacks {name}"
    if not (value.isascii() and value.isalnum() and len(value) <= _MOST):
        return f"Prolific has not filled in {name}"
    return f"its {name} is that of another study" if name == "STUDY_ID" and value != prolific else ""
