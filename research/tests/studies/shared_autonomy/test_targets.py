import numpy as np

from latentarm_research.studies.shared_autonomy.cell import WITH_ENTROPY, WITH_HELP
from latentarm_research.studies.shared_autonomy.hypotheses import MEASURE, targets
from latentarm_research.studies.shared_autonomy.preset import Preset
from latentarm_research.studies.shared_autonomy.rows import Figure
from latentarm_research.studies.targets import target_table

PRESET = Preset("tiny", learners={"slow": 2.5}, slopes=(), changes_s=(8.0,))


def found(trapped, free, helped, opened):
    """Errors of three models each."""
    latest = PRESET.latest_change.label
    named = {
        f"{WITH_HELP}, {latest}": trapped,
        f"{WITH_ENTROPY}, {latest}": free,
        f"{WITH_HELP}, slow learner": helped,
        f"{WITH_ENTROPY}, slow learner": opened,
    }
    return [
        Figure("panda_two_cups", "cae", name, MEASURE, np.array(values)[:, None])
        for name, values in named.items()
    ]


def met(*errors):
    return [one.met for one in targets(found(*errors), PRESET)]


def test_each_target_is_met_by_its_own_mark():
    apart = [0.50, 0.51, 0.52], [0.05, 0.06, 0.07]
    assert met([0.90, 0.95, 1.0], [0.05, 0.1, 0.1], *apart) == [True, True, True]
    assert met([0.80, 0.90, 0.95], [0.05, 0.1, 0.1], *apart) == [False, True, True]
    assert met([0.90, 0.95, 1.0], [0.05, 0.1, 0.2], *apart) == [True, False, True]


def test_learners_must_be_apart_with_their_intervals():
    """0.5 ± 0.25 by Student's t of three (4.30 SD / root 3): 0.1 ± 0.12 is apart, 0.15 ± 0.12 is not."""
    marks = [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]
    assert met(*marks, [0.4, 0.5, 0.6], [0.05, 0.1, 0.15])[-1]
    assert not met(*marks, [0.4, 0.5, 0.6], [0.1, 0.15, 0.2])[-1]


def test_the_table_says_what_was_missed():
    table = target_table(
        targets(found([0.5] * 3, [0.05] * 3, [0.5] * 3, [0.1] * 3), PRESET), ("arm", "model")
    )
    assert table.count("**missed**") == 1
    assert table.count("| met |") == 2
    assert "0.500 ± 0.000 and 0.100 ± 0.000" in table
