"""The README's table and the boxes of the studies' pages say what docs/evidence says, by one rule."""

import runpy

import pytest

from documentation import ROOT

SCRIPT = runpy.run_path(str(ROOT / "scripts" / "docs_blocks.py"))
WITHIN, FAVOUR, NOT, APART = SCRIPT["KINDS"]


def test_every_block_is_current() -> None:
    for path, text in SCRIPT["pages"]().items():
        assert path.read_text(encoding="utf-8") == text, "run: python scripts/docs_blocks.py"


@pytest.mark.parametrize(
    ("paper", "ours", "more", "kind"),
    [
        ("10 ± 2", "12 ± 5", {"better": "lower"}, WITHIN),
        ("10 ± 2", "8.0", {"better": "lower"}, WITHIN),
        ("10 ± 2", "7.9", {"better": "lower"}, FAVOUR),
        ("10 ± 2", "12.1", {"better": "lower"}, NOT),
        ("45 %", "228 ± 73 %", {"better": "higher"}, FAVOUR),
        ("44 of 50 trials", "55 of 60 trials", {}, WITHIN),
        ("44 of 50 trials", "40 of 60 trials", {}, NOT),
        ("Dessert under 2 minutes", "360 s on average", {}, NOT),
        ("Dessert over 5 minutes", "301 s on average", {}, WITHIN),
        ("p < .05", "t(11) = 1.7", {"same sign": "no", "same significance": "yes"}, NOT),
        ("p < .05", "t(11) = 1.7", {"same sign": "yes", "same significance": "yes"}, WITHIN),
        ("stars in a figure", "t(11) = 1.1", {"same sign": "no", "same significance": "–"}, APART),
        ("t(10) = 2.7", "not measured", {"same sign": "–", "same significance": "–"}, APART),
    ],
)
def test_one_rule_counts_alike_on_either_side(paper: str, ours: str, more: dict[str, str], kind: str) -> None:
    row = {"the paper": paper, "ours": ours, "verdict": "", **more}
    assert SCRIPT["counts"](row) == {kind: 1}


def test_a_claim_counts_in_each_of_its_cases() -> None:
    row = {"the paper": "in every case", "ours": "5 of 9", "verdict": ""}
    assert SCRIPT["counts"](row) == {WITHIN: 5, NOT: 4}
