"""Preregistration of a study: one hashed document, and a list of later departures from it."""

import hashlib
import json
from collections import Counter
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
from latentarm_research.user_studies.own.measures import OWN_MEASURES
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.words import DESIGN_WORDS
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.session import left_for

_CODE: Final = (
    *(analysis, anova, means, randomisation, claims, statistics, designs, drive_record, exclusion, scales),
)
_SHOWN: Final = 80  # letters of a value that a difference shows


def preregistration(definition: Definition, power: Mapping[str, Any] | None, written: str) -> dict[str, Any]:
    """The document: definition with hypotheses and exclusions, analysis, and power where it was computed.

    ``written`` is the time now, ISO 8601.
    """
    plan = {"written": written, **_plan(definition, power)}
    return {"digest": _digest(plan), **plan}


def _plan(definition: Definition, power: object) -> dict[str, Any]:
    code = hashlib.sha256("".join(map(getsource, _CODE)).encode()).hexdigest()
    return {
        "definition": definition.as_json(),
        "analysis": {"words": DESIGN_WORDS[definition.design].tests, "code": code, **_packages(definition)},
        "power": power,
    }


def _packages(definition: Definition) -> dict[str, dict[str, str]]:
    """The packages, with their versions, of measures that are not ours."""
    theirs = (name for name in definition.measures if name in OWN_MEASURES)
    found = {name: str(OWN_MEASURES.origin(name)) for name in theirs}
    return {"measures": found} if found else {}


def differences(path: Path, recorded: Recorded) -> list[str]:
    """List each difference between a preregistration and the study as run and analysed, as a sentence.

    Raises a `UserError` where the document was changed since it was written.
    """
    document = read_object(path)
    digest = document.pop("digest", None)
    if digest != _digest(document):
        raise UserError(f"{path} is not as it was written: its digest is that of another document.")
    written = str(document.pop("written", ""))
    now = _plan(recorded.definition, document.get("power"))
    return [*_differ("", document, now), *_differ_in_run(recorded), *_written_late(written, recorded)]


def _differ(where: str, registered: object, now: object) -> Iterator[str]:
    if isinstance(registered, dict) and isinstance(now, dict):
        one: dict[str, object] = registered
        other: dict[str, object] = now
        for name in dict.fromkeys((*one, *other)):
            yield from _differ(f"{where}.{name}".removeprefix("."), one.get(name), other.get(name))
    elif registered != now:
        was, is_now = (json.dumps(value, ensure_ascii=False) for value in (registered, now))
        yield f"{where} was {was[:_SHOWN]}, and is {is_now[:_SHOWN]}."


def _differ_in_run(recorded: Recorded) -> Iterator[str]:
    """The sizes of the run against those of its definition."""
    definition, sizes, met = recorded.definition, recorded.sizes, recorded.met
    if sizes.not_judged:
        yield f"The preset was {sizes.name}, which makes everything smaller than the definition says."
    if len(met) != definition.people:
        yield f"People: {definition.people} planned, {len(met)} took part."
    done = Counter((trial.person, trial.condition, trial.task) for trial in recorded.trials)
    everything = {condition.name for condition in definition.conditions}
    for task in definition.tasks:
        counts = {
            done[person, condition, task.name]
            for person, theirs in met.items()
            for condition in (everything if definition.design == "within" else theirs)
        }
        if counts != {task.trials}:
            driven = " to ".join(str(count) for count in sorted({min(counts), max(counts)}))
            yield f"{task.label}, trials in each condition: {task.trials} planned, {driven} driven."
        scene = scene_of(task.scene)
        planned_s, limit_s = task.trial_s or scene.time_limit_s, left_for(task, sizes, scene, ())
        if limit_s != planned_s:
            yield f"{task.label}, longest trial: {planned_s:g} s planned, {limit_s:g} s driven."


def _written_late(written: str, recorded: Recorded) -> Iterator[str]:
    """The time of the document against the first consent."""
    first = min((one.consented for one in recorded.participants), default="")
    if first and not written:
        yield f"The preregistration does not say when it was written; the first consent was given at {first}."
    elif first and first <= written:  # both UTC, to the second
        yield f"The preregistration was written at {written}, not before the first consent at {first}."


def _digest(plan: Mapping[str, Any]) -> str:
    canonical = json.dumps(plan, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(canonical.encode()).hexdigest()
