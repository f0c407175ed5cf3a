"""A definition from a JSON file, of the form of a run's ``definition.json``, and what it may ask for."""

import re
from collections.abc import Iterable
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.core.context import feature_names
from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.models.catalogue import KINDS
from latentarm_research.metrics.drives import TRIAL_MEASURES
from latentarm_research.user_studies.answers.items import names_of
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition, StudyTask
from latentarm_research.user_studies.own.measures import OWN_MEASURES
from latentarm_research.user_studies.report.boxes import MOST_CONDITIONS
from latentarm_research.user_studies.scenes import scene_names, scene_of

SUFFIX: Final = ".json"


def find_definition(
    name: str,  # a name in `latentarm_research.user_studies.catalogue.NAMES`, or the path of a JSON file
) -> Definition:
    """The study of that name, or that of a file."""
    if name in NAMES:
        return load_definition(name)
    if name.endswith(SUFFIX):
        return read_definition(Path(name))
    raise UserError(f"There is no study {name!r}: choose from {', '.join(NAMES)}, or name a {SUFFIX} file.")


def read_definition(
    path: Path,  # JSON; a field `digest`, if there is one, must be the definition's own
) -> Definition:
    """A definition from a file."""
    from latentarm_research.user_studies.own.records import (
        read_record,  # with pydantic, which help does not need
    )

    document = read_object(path)
    digest = document.pop("digest", None)
    definition = read_record(Definition, document, str(path))
    if digest is not None and digest != definition.digest:
        raise UserError(
            f"{path}: digest is not that of the definition, which was changed after it: leave the field out."
        )
    if definition.name in NAMES and definition != load_definition(definition.name):
        raise UserError(
            f"{path}: name {definition.name!r} is that of a study of the paper: choose another one."
        )
    try:
        check_definition(definition)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    return definition


MEASURED: Final = ("success_rate", *TRIAL_MEASURES, "attempts")
"""Figures of every trial that has a value for them."""

MEASURED_AT_PLATES: Final = ("goal_error_m_s", "goal_error_m")  # figures of drives at tasks with plates


NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,39}")  # names that files are called by
LONGEST_LABEL: Final = 40  # characters of a label in tables and figures
LONGEST_S: Final = 3600.0  # of a trial, s
MOST: Final = 1000  # people, trials and queries, each


def check_definition(definition: Definition) -> None:
    """Check what the records themselves cannot: that everything named exists, and fits."""
    _check_labels(definition)
    if len(definition.conditions) > MOST_CONDITIONS:
        raise UserError(
            f"conditions: there are {len(definition.conditions)}, at most {MOST_CONDITIONS} can be."
        )
    _range("people", definition.people, 2, MOST)
    _range("practice_min", definition.practice_min, 0, MOST)
    _check_conditions(definition)
    if not definition.tasks:
        raise UserError("tasks: there must be one or more.")
    for index, task in enumerate(definition.tasks, start=1):
        _check_task(definition, task, f"tasks, entry {index}")
    _check_measures(definition)
    _check_factors(definition)


def _check_labels(definition: Definition) -> None:
    for field, name in (
        ("name", definition.name),
        *(("tasks: name", task.name) for task in definition.tasks),
        *(("in_words: name", one.name) for one in definition.in_words),
        *(("multiple_choice: name", one.name) for one in definition.multiple_choice),
        *(("comparison: name", one.name) for one in definition.comparison),
        *(("comprehension: name", one.name) for one in definition.comprehension),
    ):
        if not NAME.fullmatch(name):
            raise UserError(
                f"{field} must have at most 40 of a to z, 0 to 9 and _, a letter first, not {name!r}."
            )
    labels = [
        *(("conditions: name", one.name) for one in definition.conditions),
        *(("tasks: label", one.label) for one in definition.tasks),
        *(("questionnaire: name", one.name) for one in definition.questionnaire),
        *(("questionnaire: label", one.label) for one in definition.questionnaire),
        *(("factors: name", one.name) for one in definition.factors),
        *(("hypotheses: name", one.name) for one in definition.hypotheses),
    ]
    for field, label in labels:
        if not label.strip() or len(label) > LONGEST_LABEL or "$" in label or "\n" in label:
            raise UserError(
                f"{field} must have 1 to {LONGEST_LABEL} characters on one line, without $, not {label!r}."
            )
    for field, names in (
        ("tasks", [one.name for one in definition.tasks]),
        ("hypotheses", [one.name for one in definition.hypotheses]),
        ("measures and questionnaire", [*definition.measures, *definition.scales]),
        ("questionnaire, multiple_choice, comparison and in_words", names_of(definition)),
        ("comprehension", [one.name for one in definition.comprehension]),
    ):
        _each_once(field, names)
    for one in definition.comprehension:
        if not one.attention:
            raise UserError(f"comprehension: attention of {one.name} must be the number of its right option.")


def _check_conditions(definition: Definition) -> None:
    latent = [one for one in definition.conditions if one.model]
    for one in latent:
        if one.model not in KINDS:
            raise UserError(
                f"conditions: model of {one.name} must be one of {', '.join(KINDS)}, not {one.model!r}."
            )
        try:
            feature_names(one.context)
        except UserError as error:
            raise UserError(f"conditions: context of {one.name}: {error}") from error
    if any(one.aligns != "none" for one in latent) and len({(one.model, one.context) for one in latent}) > 1:
        raise UserError(
            "conditions: where one aligns, all latent ones must have the same model and context: an alignment"
            " belongs to one model."
        )


def _check_task(definition: Definition, task: StudyTask, where: str) -> None:
    _known(f"{where}: scene", (task.scene,), scene_names())
    try:
        scene = scene_of(task.scene)
    except UserError as error:
        raise UserError(f"{where}: scene: {error}") from error
    _range(f"{where}: trials", task.trials, 1, MOST)
    _range(f"{where}: queries", task.queries, 0, MOST)
    _range(f"{where}: demonstrations_min", task.demonstrations_min, 0, MOST)
    _range(f"{where}: trial_s", task.trial_s, 0, LONGEST_S)
    if not task.choices or not set(task.choices) <= set(range(len(scene.choices))):
        raise UserError(f"{where}: choices must be one or more numbers from 0 to {len(scene.choices) - 1}.")
    begun = scene.begin(task.choices[0], np.random.default_rng(0))
    _known(f"{where}: plates", task.plates, begun.scene.names)
    if not begun.goals and any(one.assists != "none" for one in definition.conditions):
        raise UserError(f"{where}: scene {task.scene} has no goals, so that nothing can assist there.")
    if not any(one.model for one in definition.conditions):
        return
    teachers = {one.name: one.scene for one in definition.tasks if not one.trained_with}
    if task.trained_with:
        if teachers.get(task.trained_with) != task.scene:
            raise UserError(
                f"{where}: trained_with must name a task of the same scene with a model of its own."
            )
    elif not task.demonstrations_min:
        raise UserError(f"{where}: demonstrations_min must be above 0, since conditions have models.")
    elif not task.queries and any(one.aligns != "none" for one in definition.conditions):
        raise UserError(f"{where}: queries must be above 0, since a condition aligns.")


def _check_measures(definition: Definition) -> None:
    at_plates = any(task.plates for task in definition.tasks)
    measured = (*MEASURED, *(MEASURED_AT_PLATES if at_plates else ()), *OWN_MEASURES)
    if not definition.measures:
        raise UserError("measures: there must be one or more.")
    _known("measures", definition.measures, measured)
    for name in definition.measures:
        if name in OWN_MEASURES:
            OWN_MEASURES.find(name, "measures")
    known = (*definition.measures, *definition.scales)
    conditions = [one.name for one in definition.conditions]
    for one in definition.printed:
        _known("printed: measure", (one.measure,), known)
        _known("printed: subject and against", (*one.subject, *one.against), conditions)
        _known("printed: tasks", one.tasks, [task.name for task in definition.tasks])


def _check_factors(definition: Definition) -> None:
    if not definition.factors:
        return
    if len(definition.factors) != 2:
        raise UserError(f"factors: there must be two or none, not {len(definition.factors)}.")
    first, second = ((one.low[1], one.high[1]) for one in definition.factors)
    _known(
        "factors",
        (name for level in (*first, *second) for name in level),
        [one.name for one in definition.conditions],
    )
    if any(len(set(ones) & set(others)) != 1 for ones, others in product(first, second)):
        raise UserError("factors: every pair of levels must have one condition in common.")


def _range(field: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise UserError(f"{field} must be from {low:g} to {high:g}, not {value:g}.")


def _known(field: str, names: Iterable[str], known: Iterable[str]) -> None:
    all_known = list(known)
    for name in names:
        if name not in all_known:
            raise UserError(f"{field} must be of {', '.join(all_known)}, not {name!r}.")


def _each_once(field: str, names: list[str]) -> None:
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise UserError(f"{field}: {twice[0]!r} stands there twice.")
