"""The links that open a study: ours with a code, and those of the recruiting site Prolific."""

import logging
from typing import Final

from starlette.datastructures import QueryParams

from latentarm.core.errors import UserError
from latentarm.web.words.catalogue import Words
from latentarm_research.user_studies.serving.kept_options import LANGUAGE
from latentarm_research.user_studies.serving.words.catalogue import study_languages

SITE_IDS: Final = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")  # that Prolific adds to its link

_MOST: Final = 64  # characters of a code or id in a link, at most
_LOG: Final = logging.getLogger(__name__)


def link_of(given: QueryParams, prolific: str | None, words: Words) -> tuple[str, str]:
    """Code of a link of ours, or the person and visit of a link of Prolific; "" for none.

    Raises a `UserError`, for the participant, where a link of Prolific cannot be used.
    """
    if "code" in given or not any(name in given for name in SITE_IDS):
        return given.get("code", "")[:_MOST], ""
    for name in SITE_IDS:
        if code := _wrong(name, given.get(name, ""), prolific):
            what = (f"study.prolific.{code}", {"name": name})
            # No value: they are people's.
            _LOG.warning("A link of Prolific was refused: %s.", study_languages()[LANGUAGE].say(*what))
            raise UserError(words.say("study.prolific.text", {"wrong": words.say(*what)}))
    return given["PROLIFIC_PID"], given["SESSION_ID"]


def _wrong(name: str, value: str, prolific: str | None) -> str:
    """The code of the fault of an id in a link, "" for none."""
    if prolific is None:
        return "not_taken"
    if not value:
        return "lacks"
    if not (value.isascii() and value.isalnum() and len(value) <= _MOST):
        return "unfilled"
    return "other" if name == "STUDY_ID" and value != prolific else ""
