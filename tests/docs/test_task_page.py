"""The task that docs/how-to/task.md writes passes the contract test that the page recommends."""

import pytest

from documentation import ROOT, blocks
from latentarm.testing.tasks import TaskContract

PAGE = ROOT / "docs/how-to/task.md"


class TestTheTaskOfThePage(TaskContract):
    @pytest.fixture
    def task(self):
        names = {"__name__": "__main__"}
        exec(blocks(PAGE)[0].code, names)  # noqa: S102 - the page is ours
        return names["TwoBins"]()
