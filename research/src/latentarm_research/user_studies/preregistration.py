"""Preregistration of a study: one hashed document, and a list of later departures from it."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from inspect import getsource
from pathlib import Path
from typing import Any, Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.studies import claims, statistics
from latentarm_research.user_studies import designs, drive_record, exclusion
from latentarm_research.user_studies.analysis import analysis, anova, means, randomisation
from latentarm_research.user_studies.answers import scales
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.report.words import DESIGN_WORDS

_CODE: Final = (
    *(analysis, anova, means, randomisation, claims, statistics, designs, drive_record, exclusion, scales),
)
_SHOWN: Final = 80  # letters of a value that a difference shows


def preregistration(definition: Definition, power: Mapping[str, Any] | None) -> dict[str, Any]:
    """The document: definition with hypotheses and exclusions, analysis, and power where it was computed."""
    code = hashlib.sha256("".join(map(getsource, _CODE)).encode()).hexdigest()
    plan: dict[str, Any] = {
        "definition": definition.as_json(),
        "analysis": {"words": DESIGN_WORDS[definition.design].tests, "code": code},
        "power": power,
    }
    return {"digest": _digest(plan), **plan}


def differences(path: Path, definition: Definition) -> list[str]:
    """List each difference between a preregistration and the study as analysed now, as a sentence.

    Raises a `UserError` where the document was changed since it was written.
    """
    document = read_object(path)
    digest = document.pop("digest", None)
    if digest != _digest(document):
        raise UserError(f"{path} is not as it was written: its digest is that of another document.")
    now = preregistration(definition, document.get("power"))
    del now["digest"]
    return list(_differ("", document, now))


def _differ(where: str, registered: object, now: object) -> Iterator[str]:
    if isinstance(registered, dict) and isinstance(now, dict):
        one: dict[str, object] = registered
        other: dict[str, object] = now
        for name in dict.fromkeys((*one, *other)):
            yield from _differ(f"{where}.{name}".removeprefix("."), one.get(name), other.get(name))
    elif registered != now:
        was, is_now = (json.dumps(value, ensure_ascii=False) for value in (registered, now))
        yield f"{where} was {was[:_SHOWN]}, and is {is_now[:_SHOWN]}."


def _digest(plan: Mapping[str, Any]) -> str:
    canonical = json.dumps(plan, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode()).hexdigest()
