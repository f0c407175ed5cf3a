"""Questionnaires of real people: sheets, answers, scales, and the analysis of a folder of their trials."""

import csv
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawn_trials import drawn_trials
from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm_research.user_studies.answers.items import items_of, read_answers, sheet
from latentarm_research.user_studies.answers.scales import cronbach_alpha, rate
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.recorded import read_recorded

PIE = load_definition("apple_pie")
PEOPLE = 4
MET = {person: {"End-Effector", "cVAE"} for person in range(PEOPLE)}


@pytest.fixture
def real(tmp_path: Path) -> Path:
    """A folder of trials that are marked as those of real people; the test wrote them, nobody gave them."""
    folder = tmp_path / "real"
    folder.mkdir()
    about = {
        "study": "user study apple_pie",
        "definition": PIE.digest,
        "people": PEOPLE,
        "people_are": "real",
    }
    trials = drawn_trials(PIE, PEOPLE, np.random.default_rng(1), {"cVAE": -3.0})
    (folder / "config.json").write_text(json.dumps(about))
    (folder / "trials.json").write_text(json.dumps({**about, "trials": [one.as_json() for one in trials]}))
    return folder


def filled(path: Path) -> Path:
    """A sheet that everybody filled in alike: they agree with cVAE, and are in the middle elsewhere."""
    items = items_of(PIE)
    assert main(["study", "questions", "apple_pie", "--people", str(PEOPLE), "--out", str(path)]) == 0
    with path.open(encoding="utf-8", newline="") as stream:
        lines = list(csv.DictReader(stream))
    for line in lines:
        agrees = 6 if line["condition"] == "cVAE" else 4
        own = agrees + (int(line["person"]) + int(line["item"][-1])) % 2
        line["answer"] = str(8 - own if items[line["item"]][1].reversed else own)
    with path.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.DictWriter(stream, lines[0].keys())
        rows.writeheader()
        rows.writerows(lines)
    return path


def test_everybody_is_asked_every_item_after_each_condition_in_an_order_of_their_own() -> None:
    asked = sheet(PIE, 6, seed=0)
    assert asked == sheet(PIE, 6, seed=0)
    assert set(Counter((one.person, one.condition, one.item) for one in asked).values()) == {1}
    assert len(asked) == 6 * len(PIE.conditions) * len(items_of(PIE))
    orders = {tuple(one.item for one in asked if one.person == person) for person in range(6)}
    assert len(orders) == 6
    with pytest.raises(UserError, match="no questionnaire"):
        sheet(load_definition("harmonic"), 2, seed=0)


def test_a_sheet_to_print_has_a_box_for_each_point(tmp_path: Path) -> None:
    path = tmp_path / "sheet.md"
    assert main(["study", "questions", "eating", "--people", "2", "--out", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert text.count("## Person 1, way of driving ") == 4
    assert "SA" not in text  # people read no condition
    assert text.count("☐") == 7 * 2 * 4 * len(items_of(load_definition("eating")))
    assert main(["study", "questions", "eating", "--out", str(path)]) == 2  # never over answers


def test_an_alpha_is_that_of_a_published_table() -> None:
    # Two items with the same answers are perfectly consistent; independent ones are not.
    same = np.array([[1.0, 1.0], [2.0, 2.0], [5.0, 5.0]])
    found = cronbach_alpha(same)
    assert found is not None
    assert found == pytest.approx((1.0, 1.0, 1.0))
    opposite = cronbach_alpha(np.array([[1.0, 2.0], [2.0, 1.0], [1.0, 2.0], [2.0, 1.0]]))
    assert opposite is None  # sums do not vary


@settings(max_examples=30)
@given(st.integers(3, 20), st.integers(2, 6), st.integers(0, 1000))
def test_an_interval_of_alpha_holds_it_and_is_wider_for_fewer_people(n: int, k: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    table: FloatArray = rng.normal(size=(n, 1)) + rng.normal(size=(n, k))
    found, doubled = cronbach_alpha(table), cronbach_alpha(np.concatenate([table, table]))
    assert found is not None
    assert doubled is not None
    alpha, low, high = found
    assert low < alpha < high <= 1.0
    assert alpha <= 1.0
    assert doubled[0] == pytest.approx(alpha)
    assert doubled[1] > low


def test_the_interval_of_alpha_is_that_of_feldt() -> None:
    # Feldt, Woodruff and Salih (1987): alpha .79 of 41 people and 26 items lies in (.68, .87), central 95 %.
    from scipy.stats import f

    low = 1.0 - 0.21 * f.ppf(0.975, 40, 1000)
    high = 1.0 - 0.21 * f.ppf(0.025, 40, 1000)
    rng = np.random.default_rng(0)
    table = rng.normal(size=(41, 1)) + 2.6 * rng.normal(size=(41, 26))
    found = cronbach_alpha(table)
    assert found is not None
    share = (1.0 - found[0]) / 0.21
    assert 1.0 - found[1] == pytest.approx(share * (1.0 - low))
    assert 1.0 - found[2] == pytest.approx(share * (1.0 - high))


def test_reversed_items_are_turned_and_a_left_out_item_leaves_no_score(tmp_path: Path) -> None:
    path = filled(tmp_path / "answers.csv")
    trials = drawn_trials(PIE, PEOPLE, np.random.default_rng(1))
    ratings = rate(PIE, read_answers(path, PIE, MET), trials)
    assert {round(one.measures["ease"], 6) for one in ratings.scores if one.condition == "cVAE"} == {6.5}
    lines = path.read_text(encoding="utf-8").splitlines()
    place = next(index for index, line in enumerate(lines) if line.startswith("0,cVAE,ease_1,"))
    lines[place] = lines[place].rpartition(",")[0] + ","
    path.write_text("\n".join(lines), encoding="utf-8")
    scores = rate(PIE, read_answers(path, PIE, MET), trials).scores
    first = next(one for one in scores if (one.person, one.condition) == (0, "cVAE"))
    assert set(first.measures) == set(PIE.scales) - {"ease"}


FAULTS: list[tuple[str, Callable[[list[str]], str]]] = [
    ("no item 'ease_9'", lambda line: ",".join([line[0], line[1], "ease_9", "", "3"])),
    ("no person '7'", lambda line: ",".join(["7", *line[1:3], "", "3"])),
    ("not met the condition 'R'", lambda line: ",".join([line[0], "R", line[2], "", "3"])),
    ("from 1 to 7, not '8'", lambda line: ",".join([*line[:3], "", "8"])),
    ("from 1 to 7, not '3.5'", lambda line: ",".join([*line[:3], "", "3.5"])),
    ("4 fields, not 5", lambda line: ",".join([*line[:3], "3"])),
]


@pytest.mark.parametrize(("said", "change"), FAULTS, ids=[said for said, _ in FAULTS])
def test_a_wrong_answer_is_refused_with_its_line(
    said: str, change: Callable[[list[str]], str], tmp_path: Path
) -> None:
    path = filled(tmp_path / "answers.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[4] = change(lines[4].split(","))
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(UserError, match=rf"answers\.csv: line 5: .*{said}"):
        read_answers(path, PIE, MET)
    lines[4] = lines[3]
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(UserError, match=r"line 5: .* before, in line 4"):
        read_answers(path, PIE, MET)


def test_real_people_are_analysed_with_their_answers(real: Path, tmp_path: Path) -> None:
    answers, out = filled(tmp_path / "answers.csv"), tmp_path / "out"
    assert main(["study", "analyse", str(real), "--answers", str(answers), "--out", str(out)]) == 0
    claims = json.loads((out / "hypotheses.json").read_text())
    rated = [one for one in claims if one["claim"]["measure"] in PIE.scales]
    assert rated
    assert all(one["n"] == PEOPLE and one["mean"] == 6.5 for one in rated)
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "4 real people" in page
    assert "simulated" not in page
    assert "Cronbach" in page
    assert (out / "ratings.png").exists()
    recorded = read_recorded(real)
    assert (recorded.people_are, recorded.traces) == ("real", ())


def test_simulated_people_have_no_answers(
    real: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("config.json", "trials.json"):
        document = json.loads((real / name).read_text())
        (real / name).write_text(
            json.dumps({**document, "people_are": "simulated", "simulated": PEOPLE, "seed": 0})
        )
        if name == "config.json":
            with pytest.raises(UserError, match="people_are must be 'simulated'"):
                read_recorded(real)
    from latentarm_research.people.population import draw_people

    people = [dict(one.as_json()) for one in draw_people(PEOPLE, 0)]
    (real / "people.json").write_text(json.dumps({"people": people}))
    assert read_recorded(real).who == "4 simulated people"
    answers = filled(tmp_path / "answers.csv")
    assert main(["study", "analyse", str(real), "--answers", str(answers), "--out", str(tmp_path / "x")]) == 2
    assert "who have no opinions" in capsys.readouterr().err
    assert not (tmp_path / "x").exists()
