import json
from collections.abc import Callable
from pathlib import Path

import pytest

from latentarm.experiments.properties.preset import PRESETS, Preset
from latentarm.metrics.results import read_results

Run = Callable[..., tuple[int, str, str]]

TINY = Preset(
    "smoke",
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=1,
    hidden=(8,),
    reach_pairs=3,
    reach_goals=2,
    states=5,
    grid=5,
    noises_rad=(0.0,),
)
PROPERTIES = ("reproduce", "properties", "--preset", "smoke", "--task", "reach", "--jobs", 1)


def test_the_properties_for_people_and_for_machines(
    run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PRESETS, "smoke", TINY)
    code, out, err = run(*PROPERTIES)
    assert code == 0
    assert "reach, simulated" in out
    assert "reproduced/properties/results.md" in out
    assert "8 models on reach" in err
    written = read_results(Path("reproduced/properties/results.json"))

    code, out, err = run(*PROPERTIES, "--json")
    assert code == 0
    assert json.loads(out) == [row.as_json() for row in written]
    assert "results.md" in err
