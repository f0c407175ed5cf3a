"""The samples of docs/data.md are made and imported, block after block, as a reader would."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from documentation import ROOT, run_page
from latentarm.demonstrations.dataset import read_dataset

PAGE = ROOT / "docs/data.md"


def test_every_sample_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record_on_the_page: Callable[[Path], None]
) -> None:
    monkeypatch.chdir(tmp_path)
    record_on_the_page(Path("teleop/journal.sqlite"))
    names = run_page(PAGE, {})
    for name in ("from-numpy", "from-csv", "from-robomimic"):
        states = np.concatenate([episode.state for episode in read_dataset(Path(name)).episodes])
        np.testing.assert_allclose(states, names["motion"], atol=1e-6)
    arm = read_dataset(Path("from-lerobot"))
    np.testing.assert_allclose(arm.episodes[0].state, np.deg2rad(names["states"])[:, :5], atol=1e-6)
    assert arm.import_record["units"].startswith("deg (as told)")
