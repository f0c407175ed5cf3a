"""The notebook runs from top to bottom, and shows what its text says."""

import json
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest

from documentation import ROOT

NOTEBOOK = ROOT / "examples" / "latent_space.ipynb"


def test_the_notebook_runs_and_shows_what_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    with mpl.rc_context({"backend": "agg"}):
        for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), NOTEBOOK.name, "exec"), names)  # noqa: S102 - the notebook is ours
                assert cell["outputs"] == [], "keep it without outputs"
    assert Path("ring.png").exists()
    assert Path("latents.png").exists()
    assert names["latents"]["cAE"].shape == names["latents"]["homogeneous"].shape == (len(names["states"]), 2)
    assert names["properties"]["homogeneous"] == pytest.approx((0, 0), abs=1e-9)
    assert min(names["properties"]["cAE"]) > 0.01
