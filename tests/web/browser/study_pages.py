"""Steps of a person who takes a study in the browser."""

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


def assert_recorded(folder: Path) -> None:
    """Check a study of two conditions in which each of the four items was answered by 6."""
    recorded = read_recorded(folder)
    assert [one.answer for one in recorded.answers] == [6] * 8
    assert all(one.measures["path_length"] > 0.0 for one in recorded.trials)
