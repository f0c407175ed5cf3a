import dataclasses
import json
from collections.abc import Iterator
from typing import Any

import pytest

from latentarm.core.errors import UserError
from latentarm.evaluation.measures import MEASURES
from latentarm.models.catalogue import KINDS
from latentarm_research.studies.claims import Claim
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Condition, Definition
from latentarm_research.user_studies.device_limits import DeviceLimits
from latentarm_research.user_studies.exclusion import Exclusion
from latentarm_research.user_studies.questionnaire import Item, MultipleChoice, Question, Scale
from latentarm_research.user_studies.scenes import scene_of

DEFINITIONS = {name: load_definition(name) for name in NAMES}


def other(value: Any) -> Any:
    """A value of the same kind that differs."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + 1
    if isinstance(value, str):
        return value + "x"
    return None if value is not None else 1.0


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where every figure and text of nested JSON stands."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, (*path, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from leaves(inner, (*path, index))
    else:
        yield path


def test_the_digest_is_that_of_every_field_of_every_record() -> None:
    definition = DEFINITIONS["eating"]
    document = definition.as_json()
    later = {"public_title", "in_words", "multiple_choice", "comprehension", "comparison", "device"}
    assert set(document) == {field.name for field in dataclasses.fields(Definition)} - later
    canonical = json.dumps(document, sort_keys=True)
    for path in leaves(document):
        changed: Any = json.loads(canonical)
        place = changed
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = other(place[path[-1]])
        assert json.dumps(changed, sort_keys=True) != canonical


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Definition)])
def test_the_digest_changes_with_any_field(field: str) -> None:
    definition = DEFINITIONS["eating"]
    changes: dict[str, Any] = {
        "people": 13,
        "practice_min": 4.0,
        "conditions": (*definition.conditions, Condition("more", "more", "modes")),
        "orders": (("LA+SA", "R", "LA", "R+SA"),),
        "tasks": (*definition.tasks, DEFINITIONS["harmonic"].tasks[0]),
        "hypotheses": definition.hypotheses[:1],
        "measures": (*definition.measures, "stops"),
        "in_words": (Question("wish", "What do you wish for?"),),
        "multiple_choice": (MultipleChoice("again", "Once more?", ("yes", "no")),),
        "comprehension": (MultipleChoice("arm", "The arm is", ("real", "simulated"), attention=2),),
        "comparison": (Question("again", "Which one would you use again?"),),
        "device": DeviceLimits(jitter_ms=100.0),
    }
    value = getattr(definition, field)
    if field not in changes:
        changes[field] = f"{value}." if isinstance(value, str) else value[:-1]
    changed = dataclasses.replace(definition, **{field: changes[field]})
    assert changed.digest != definition.digest


def test_the_digest_of_the_same_definition_is_the_same() -> None:
    assert len({definition.digest for definition in DEFINITIONS.values()}) == len(NAMES)
    for name, definition in DEFINITIONS.items():
        assert dataclasses.replace(definition).digest == load_definition(name).digest


@pytest.mark.parametrize("name", NAMES)
def test_a_definition_names_only_what_there_is(name: str) -> None:
    definition = DEFINITIONS[name]
    assert definition.people == 12
    assert set(definition.measures) <= set(MEASURES)
    assert {condition.model for condition in definition.conditions if condition.model} <= set(KINDS)
    for task in definition.tasks:
        assert set(task.choices) <= set(range(len(scene_of(task.scene).choices)))
        assert not task.trained_with or task.trained_with in {one.name for one in definition.tasks}
    conditions = {condition.name for condition in definition.conditions}
    for printed in definition.printed:
        assert {*printed.subject, *printed.against} <= conditions
        assert printed.measure in {*definition.measures, *definition.scales}


def test_the_protocols_are_those_of_the_paper() -> None:
    assert [task.queries for task in DEFINITIONS["alignment"].tasks] == [7, 10, 30]
    assert all(task.demonstrations_min < 7 for task in DEFINITIONS["apple_pie"].tasks)
    assert sum(task.demonstrations_min for task in DEFINITIONS["eating"].tasks) == 20
    assert DEFINITIONS["eating"].condition("LA+SA").context == ("joints", "belief")
    assert [condition.weight for condition in DEFINITIONS["harmonic"].conditions] == [
        0,
        1 / 3,
        2 / 3,
        1,
        0,
        0,
    ]
    assert DEFINITIONS["case_study"].orders == (("End-Effector", "LA+SA"), ("LA+SA", "End-Effector"))


def test_a_definition_that_contradicts_itself_is_refused() -> None:
    definition = DEFINITIONS["harmonic"]
    with pytest.raises(UserError, match="LA\\+SA"):
        dataclasses.replace(definition, hypotheses=DEFINITIONS["eating"].hypotheses)
    with pytest.raises(UserError, match="is by stops"):
        dataclasses.replace(definition, exclusions=(Exclusion("stops", "more", 9.0, "the arm stopped"),))
    with pytest.raises(UserError, match="one item or more"):
        Scale("ease", "Ease", ())
    with pytest.raises(UserError, match="two points or more"):
        Scale("ease", "Ease", (Item("It was easy."),), points=1)
    with pytest.raises(UserError, match="margin"):
        Claim("time_s", ("a",), ("b",), "equal")
    with pytest.raises(UserError, match="compare some"):
        Claim("time_s", ("a",), ("a",), "less")
    with pytest.raises(UserError, match="latent"):
        Condition("x", "x", "latent")
    with pytest.raises(UserError, match="choose from harmonic"):
        load_definition("nothing")
