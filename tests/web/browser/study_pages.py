"""Steps of a person who takes a study in the browser."""

from collections.abc import Mapping
from pathlib import Path

from playwright.sync_api import Page

from latentarm_research.user_studies.recorded import read_recorded


def drive_trial(page: Page) -> None:
    """Hold a key, with the stick focused, until the trial is over; enable the arm again when it stops."""
    for _ in range(100):
        page.keyboard.press("Enter")
        page.wait_for_timeout(100)
        page.keyboard.down("ArrowUp")
        page.wait_for_timeout(1200)
        if page.url.endswith("/study"):
            return
        page.keyboard.up("ArrowUp")
    raise AssertionError("the trial is never over")


def assert_recorded(folder: Path, answers: Mapping[str, int | str]) -> None:
    """Check a study in which each question was answered alike after each of two conditions, and compared."""
    recorded = read_recorded(folder)
    conditions = sorted({one.condition for one in recorded.trials})
    found = {(one.condition, one.item): one.answer for one in recorded.answers}
    compared = [found.pop((one, "better")) for one in conditions]
    assert sorted(compared) == ["1", "2"]
    assert len(conditions) == 2
    assert found == {(one, item): answer for one in conditions for item, answer in answers.items()}
    assert all(one.measures["path_length"] > 0.0 for one in recorded.trials)
