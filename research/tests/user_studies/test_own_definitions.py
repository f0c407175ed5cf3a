"""Definitions that a laboratory writes as JSON."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.own.definition_file import (
    check_definition,
    find_definition,
    read_definition,
)
from latentarm_research.user_studies.serving.page_drive import check_served

EXAMPLE = Path(__file__).parents[3] / "examples" / "pie_apart.json"
OWN: dict[str, Any] = json.loads(EXAMPLE.read_text(encoding="utf-8"))


def leaves(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where every figure and text of nested JSON stands."""
    if isinstance(value, dict | list):
        inner = value.items() if isinstance(value, dict) else enumerate(value)
        return [leaf for key, one in inner for leaf in leaves(one, (*path, key))]
    return [path]


def changed(change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    document = json.loads(json.dumps(OWN))
    change(document)
    return document


def written(document: object, folder: Path) -> Path:
    path = folder / "mine.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", NAMES)
def test_the_papers_studies_are_read_back_as_they_are(name: str, tmp_path: Path) -> None:
    definition = load_definition(name)
    path = written({"digest": definition.digest, **definition.as_json()}, tmp_path)
    assert read_definition(path) == definition


def test_the_example_is_a_study_between_people() -> None:
    definition = find_definition(str(EXAMPLE))
    assert (definition.design, definition.people) == ("between", 24)
    check_definition(definition)
    check_served(definition)


def test_a_value_of_another_kind_is_refused_with_its_file(tmp_path: Path) -> None:
    places = leaves(OWN)
    assert len(places) > 80
    for place in places:
        document = changed(lambda one: None)
        inner: Any = document
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = {"x": 1}
        with pytest.raises(UserError, match=r"mine\.json") as refused:
            read_definition(written(document, tmp_path))
        named = [key for key in place if isinstance(key, str)]
        assert named[-1] in str(refused.value)


FAULTS: list[tuple[Callable[[dict[str, Any]], object], str]] = [
    (lambda one: one.pop("people"), "lacks the field 'people'"),
    (lambda one: one.update(colour="red"), "unknown field 'colour'"),
    (lambda one: one.update(digest="0" * 64), "leave the field out"),
    (lambda one: one.update(name="apple_pie"), "study of the paper"),
    (lambda one: one.update(name="../pie"), "name must have"),
    (lambda one: one.update(people=1), "two people"),
    (lambda one: one.update(design="both"), "must be 'within' or 'between'"),
    (lambda one: one.update(orders=[["cVAE", "End-Effector"]]), "leave them empty"),
    (lambda one: one["conditions"][1].update(model="gan"), "model of cVAE"),
    (lambda one: one["conditions"][1].update(context=["gripper"]), "begins with the joints"),
    (lambda one: one["conditions"][0].update(assists="blending"), "no goals"),
    (lambda one: one["conditions"][0].update(name="a\u202eb"), "cannot be printed"),
    (lambda one: one["tasks"][0].update(label="$x$"), "without \\$"),
    (lambda one: one["tasks"][0].update(scene="moon"), "tasks, entry 1: scene must be of .*, not 'moon'"),
    (lambda one: one.update(practice="before every trial"), "unknown field 'practice'"),
    (lambda one: one["conditions"][0].update(name="cVAE"), "two conditions of the name cVAE"),
    (lambda one: one.update(design="within", orders=[["cVAE"]]), "is cVAE: it must have each of End-Eff"),
    (lambda one: one.update(design="within", orders=[["cVAE", "cVAE"]]), "is cVAE, cVAE: it must have each"),
    (lambda one: one.update(design="within", orders=[["cVAE", "R"]]), "is cVAE, R: it must have each"),
    (lambda one: one.update(design="within", orders=[[]]), "is empty: it must have each"),
    (lambda one: one["tasks"][0].update(choices=[3]), "from 0 to 2"),
    (lambda one: one["tasks"][0].update(trials=0), "trials must be from 1"),
    (lambda one: one["tasks"][0].update(plates=["saucer"]), "plates must be of"),
    (lambda one: one["tasks"][0].update(demonstrations_min=0.0), "demonstrations_min"),
    (lambda one: one["measures"].append("charm"), "measures must be of"),
    (lambda one: one["measures"].append("goal_error_m"), "measures must be of"),
    (lambda one: one["measures"].append("ease"), "twice"),
    (lambda one: one["exclusions"][0].update(measure="stops"), "exclusion of the study .* is by stops"),
    (lambda one: one["hypotheses"][0]["claims"][0].update(subject=["R"]), "does not have"),
    (lambda one: one["questionnaire"][0]["items"].clear(), "one item or more"),
    (lambda one: one.update(factors=[{"name": "a", "low": ["b", []], "high": ["c", []]}]), "two or none"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "said"), FAULTS, ids=[said for _, said in FAULTS])
def test_a_definition_that_cannot_be_run_is_refused(
    change: Callable[[dict[str, Any]], object], said: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=said) as refused:
        read_definition(written(changed(change), tmp_path))
    assert str(refused.value).startswith(str(tmp_path / "mine.json"))
    assert "--" not in str(refused.value)


def test_the_published_schema_is_that_of_a_definition() -> None:
    published = EXAMPLE.parents[1] / "docs" / "study.schema.json"
    assert json.loads(published.read_text()) == TypeAdapter(Definition).json_schema()


def test_show_prints_what_a_file_may_hold(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "show", str(EXAMPLE), "--json"]) == 0
    shown = tmp_path / "shown.json"
    shown.write_text(capsys.readouterr().out, encoding="utf-8")
    assert read_definition(shown) == read_definition(EXAMPLE)
    assert main(["study", "show", "nothing"]) == 2
    assert "choose from harmonic" in capsys.readouterr().err
