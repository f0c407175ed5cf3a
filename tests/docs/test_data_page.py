"""The samples of docs/data.md are made and imported, block after block, as a reader would."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.demonstrations.dataset import read_dataset

PAGE = Path(__file__).parents[2] / "docs/data.md"


def test_every_sample_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record_on_the_page: Callable[[Path], None]
) -> None:
    monkeypatch.chdir(tmp_path)
    record_on_the_page(Path("teleop/journal.sqlite"))
    names: dict[str, Any] = {}
    for language, block in re.findall(r"```(python|sh)\n(.*?)```", PAGE.read_text(), flags=re.DOTALL):
        if language == "python":
            exec(block, names)  # noqa: S102 - the page is ours
            continue
        for line in block.splitlines():
            assert main(shlex.split(line, comments=True)[1:]) == 0, line
    for name in ("from-numpy", "from-csv", "from-robomimic"):
        states = np.concatenate([episode.state for episode in read_dataset(Path(name)).episodes])
        np.testing.assert_allclose(states, names["motion"], atol=1e-6)
    arm = read_dataset(Path("from-lerobot"))
    np.testing.assert_allclose(arm.episodes[0].state, np.deg2rad(names["states"])[:, :5], atol=1e-6)
    assert arm.import_record["units"].startswith("deg (as told)")
