"""The dataset of a study says all that its report says, to six digits, in Python and in R."""

import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drawn_trials import drawn_trials
from latentarm.cli import main
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.answers.items import Answer, items_of
from latentarm_research.user_studies.answers.scales import rate
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.export.dataset import write_dataset
from latentarm_research.user_studies.questionnaire import Item, MultipleChoice, Scale
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.page import report_of
from latentarm_research.user_studies.sizes import PRESETS

USED = MultipleChoice("used", "Which do you use?", ("cane", "wheelchair", "none"), several=True)
EATING = replace(
    load_definition("eating"),
    questionnaire=(
        *load_definition("eating").questionnaire,
        Scale("pain", "Pain", (Item("It hurt."),), 100, "not at all", "much", slider=True),
    ),
    multiple_choice=(USED,),
)
BETWEEN = replace(EATING, design="between", people=16)
PIE = load_definition("apple_pie")

SCRIPTS = [
    [sys.executable, "-I", "tables.py"],
    pytest.param(
        ["Rscript", "--vanilla", "tables.R"],
        marks=pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed"),
    ),
]


def recorded(definition: Definition) -> Recorded:
    """A study that nobody took part in; some trials do not count, and some answers were left out."""
    rng = np.random.default_rng(43)
    effects = {one.name: float(place) for place, one in enumerate(definition.conditions)}
    drawn = drawn_trials(definition, definition.people, rng, effects)
    trials = [
        replace(one, measures={**one.measures, "input_magnitude": 0.0}) if index in (3, 40) else one
        for index, one in enumerate(drawn)
    ]
    met = design_of(definition).orders(definition, definition.people, np.random.default_rng(0))
    answers = [
        Answer(one.person, one.condition, item, int(rng.integers(1, scale.points + 1)))
        for one in {(one.person, one.condition): one for one in trials}.values()
        for item, (scale, _) in items_of(definition).items()
        if rng.uniform() < 0.98
    ]
    assert met
    for one in list(dict.fromkeys((one.person, one.condition) for one in trials))[:-1]:
        for question in definition.multiple_choice:
            chosen = [str(number) for number in (1, 2, 3) if rng.uniform() < 0.5]
            answers += [Answer(*one, question.name, ";".join(chosen))] if chosen else []
    return Recorded(definition, "real", tuple(trials), (), (), PRESETS["paper"], tuple(answers))


def tables_of(command: Sequence[str], dataset: Path, out: Path) -> dict[str, list[dict[str, str]]]:
    """Run an analysis script on a dataset; return its output by table."""
    *start, script = command
    subprocess.run([*start, str(dataset / "analysis" / script), str(out)], check=True, cwd=out.parent)
    return {path.stem: list(csv.DictReader(path.read_text().splitlines())) for path in out.glob("*.csv")}


def agree(line: Mapping[str, str], figures: Mapping[str, Any], names: Sequence[str]) -> None:
    """Check that figures of a line are those of the report, to six digits."""
    for name in names:
        said, wanted = line[name] or None, figures[name]
        assert (said is None) == (wanted is None), (name, said, wanted)
        if said is not None:
            assert float(said) == pytest.approx(wanted, rel=1e-6, abs=1e-12), (name, line)


EVERY_DESIGN = pytest.mark.parametrize(
    "definition",
    [EATING, pytest.param(BETWEEN, marks=pytest.mark.slow), pytest.param(PIE, marks=pytest.mark.slow)],
    ids=["within", "between", "equal"],
)


@pytest.mark.parametrize("command", SCRIPTS)
@EVERY_DESIGN
def test_a_script_makes_the_tables_of_the_report_from_csv_files_alone(
    definition: Definition, command: list[str], tmp_path: Path
) -> None:
    study = recorded(definition)
    write_dataset(tmp_path / "dataset", study)
    tables = tables_of(command, tmp_path / "dataset", tmp_path / "tables")
    ratings = rate(definition, study.answers, study.trials)
    report = report_of(study, "", ratings)
    assert len(tables["results"]) == len(report.rows)
    for row in report.rows:
        (line,) = (
            one
            for one in tables["results"]
            if (one["task"], one["condition"], one["measure"]) == (row.task, row.condition, row.measure)
        )
        agree(line, {"n": row.n, "mean": row.mean, "sd": row.sd}, ("n", "mean", "sd"))
    for one in ratings.rated:
        (line,) = (
            line
            for line in tables["scales"]
            if (line["scale"], line["condition"]) == (one.scale, one.condition)
        )
        agree(line, vars(one), ("n", "mean", "sd", "alpha", "alpha_low", "alpha_high"))
    for chosen in ratings.chosen:
        lines = (
            line
            for line in tables["options"]
            if (line["item"], line["condition"]) == (chosen.question, chosen.condition)
        )
        found = {int(line["option"]): (int(line["n"]), int(line["chosen"])) for line in lines}
        assert found == {number: (chosen.n, count) for number, count in enumerate(chosen.counts, start=1)}
    assert len(tables["claims"]) == len(report.tests)
    for line, claim in zip(tables["claims"], report.tests, strict=True):
        said: Any = claim.as_json()
        test, model = (
            said["test"] or dict.fromkeys(["difference", "low", "high", "t", "dof", "d", "g"]),
            said["model"],
        )
        mixed = model["mixed"] or {"estimate": None, "se": None}
        figures = {**test, **model, **mixed, **said, "p_randomisation": model["p"]}
        agree(line, figures, [name for name in line if name not in ("hypothesis", "measure")])
    effects = json.loads(json.dumps(report.documents["analysis.json"]))["anova"]
    assert len(tables.get("anova", [])) == sum(map(len, effects.values()))
    for line in tables.get("anova", []):
        (effect,) = (one for one in effects[line["measure"]] if one["name"] == line["effect"])
        agree(line, effect, ("f", "dof", "dof_error", "p", "eta"))


def without(definition: Definition, out: Sequence[str], people: int) -> Recorded:
    """So many people of a study, of whom no trial counts with the conditions in ``out``."""
    study = recorded(definition)
    trials = tuple(
        replace(one, measures={**one.measures, "input_magnitude": 0.0}) if one.condition in out else one
        for one in study.trials
        if one.person < people
    )
    answers = tuple(one for one in study.answers if one.person < people)
    return replace(study, trials=trials, answers=answers)


@pytest.mark.parametrize("command", SCRIPTS)
@EVERY_DESIGN
@pytest.mark.parametrize(
    "left",
    [
        "one condition excluded",
        pytest.param("everything excluded", marks=pytest.mark.slow),
        "one person",
    ],
)
def test_a_script_leaves_cells_empty_where_nothing_is_left_to_compare(
    definition: Definition, command: list[str], left: str, tmp_path: Path
) -> None:
    names = [one.name for one in definition.conditions]
    out = {"one condition excluded": names[-1:], "everything excluded": names}.get(left, [])
    study = without(definition, out, 1 if left == "one person" else definition.people)
    write_dataset(tmp_path / "dataset", study)
    tables = tables_of(command, tmp_path / "dataset", tmp_path / "tables")
    report = report_of(study, "", rate(definition, study.answers, study.trials))
    assert len(tables.get("results", [])) == len(report.rows)
    assert len(tables["claims"]) == len(report.tests)
    for line, claim in zip(tables["claims"], report.tests, strict=True):
        said: Any = claim.as_json()
        test = said["test"] or dict.fromkeys(["difference", "t", "d"])
        figures = {**test, **said, "p_randomisation": said["model"]["p"]}
        agree(line, figures, ["n", "mean", "difference", "t", "d", "p", "p_holm", "p_randomisation"])


def test_a_dataset_follows_psych_ds_and_its_codebook_has_every_column(tmp_path: Path) -> None:
    definition = load_definition("eating")
    study = recorded(definition)
    folder, dataset = tmp_path / "people", tmp_path / "dataset"
    write_json(
        folder / "config.json",
        {"study": definition.study, "definition": definition.digest, "people_are": "real"},
    )
    write_json(folder / "trials.json", study.documents["trials.json"])
    assert main(["study", "export", str(folder), "--out", str(dataset)]) == 0
    described = json.loads((dataset / "dataset_description.json").read_text())
    assert (described["@context"], described["@type"]) == ("https://schema.org", "Dataset")
    known = {one["name"] for one in described["variableMeasured"]}
    for path in (dataset / "data").iterdir():
        assert path.name.startswith("study-Eating_description-")
        assert path.name.endswith("_data.csv")
        assert set(next(csv.reader(path.read_text().splitlines()))) <= known
    codebook = (dataset / "documentation" / "codebook.csv").read_text().splitlines()
    assert {line["name"] for line in csv.DictReader(codebook)} == known
    # A second export does not overwrite the first.
    assert main(["study", "export", str(folder), "--out", str(dataset)]) == 2
