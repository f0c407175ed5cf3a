from pathlib import Path

import numpy as np
import pytest

from drawn_trials import drawn_trials
from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.power import NUMBERS, Power, power_of

ALIGNMENT = load_definition("alignment")


def test_more_people_find_a_large_effect_more_often() -> None:
    trials = drawn_trials(ALIGNMENT, 12, np.random.default_rng(4), {"All Priors": -2.0})
    power = power_of(ALIGNMENT, trials, 10, seed=0)
    assert power.as_json() == power_of(ALIGNMENT, trials, 10, seed=0).as_json()
    (shares,) = power.hypotheses.values()
    assert len(shares) == len(NUMBERS)
    assert shares[-1] == 1.0
    assert shares[0] < 1.0
    assert all(0 <= share <= 1 for of_claim in power.claims.values() for share in of_claim)


def test_enough_people_are_those_from_whom_on_it_stays_enough() -> None:
    power = Power(12, 10, (4, 8, 12), {}, {})
    assert power.needed((0.2, 0.9, 0.8), 0.8) == 8
    assert power.needed((0.9, 0.7, 0.8), 0.8) == 12
    assert power.needed((0.9, 0.9, 0.7), 0.8) is None


def test_power_without_people_is_refused() -> None:
    trials = drawn_trials(ALIGNMENT, 2, np.random.default_rng(4))
    with pytest.raises(UserError, match="3 people"):
        power_of(ALIGNMENT, trials, 10, seed=0)
    with pytest.raises(UserError, match="draws"):
        power_of(ALIGNMENT, trials, 0, seed=0)


def test_the_command_draws_from_the_people_of_a_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = {"study": ALIGNMENT.study, "definition": ALIGNMENT.digest, "people_are": "real"}
    trials = [one.as_json() for one in drawn_trials(ALIGNMENT, 4, np.random.default_rng(4))]
    write_json(tmp_path / "run" / "config.json", about)
    write_json(tmp_path / "run" / "trials.json", {**about, "trials": trials})
    given = ["--results", str(tmp_path / "run"), "--draws", "1", "--out", str(tmp_path / "power")]
    assert main(["study", "power", "alignment", *given]) == 0
    assert read_object(tmp_path / "power" / "power.json")["drawn_from_people"] == 4
    assert main(["study", "power", "harmonic", *given]) == 2
    assert "holds a run of the study alignment" in capsys.readouterr().err
