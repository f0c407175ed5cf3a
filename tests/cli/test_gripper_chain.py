"""A gripper from a recording of a real arm to a drive, and on to a model that learns from that drive."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.demonstrations.contexts import context_layout
from latentarm.demonstrations.dataset import read_dataset
from latentarm.models.saving import load_decoder

Run = Callable[..., tuple[int, str, str]]

BANANA = Path(__file__).resolve().parents[3] / "shared" / "demonstrations" / "panda_pick_banana.npz"

MOVED_RAD = 0.4
"""How far from where the gripper closes the arm is where an excerpt begins and ends."""


@pytest.fixture
def picks(workplace: Path) -> Path:
    """How people reached for a banana, closed the gripper about it, and went on, five times."""
    if not BANANA.is_file():
        pytest.skip("the real recordings are not beside the project")
    with np.load(BANANA, allow_pickle=False) as arrays:
        q, toggles = arrays["q"], arrays["gripper_toggles"]
        closes = [toggles[toggles >= start][0] for start in (0, *arrays["episode_ends"][:4])]
    excerpts: list[np.ndarray] = []
    before: list[int] = []
    for at in closes:
        away = np.flatnonzero(np.linalg.norm(q - q[at], axis=1) > MOVED_RAD)
        first, last = away[away < at][-1], away[away > at][0]
        excerpts.append(q[first : last + 1])
        before.append(at - first)
    ends = np.cumsum([len(one) for one in excerpts])
    when = ends - [len(one) for one in excerpts] + before
    np.savez("picks.npz", q=np.concatenate(excerpts), episode_ends=ends, rate_hz=10.0, gripper_toggles=when)
    return Path("picks.npz")


def test_toggles_of_a_real_arm_become_a_gripper_that_closes_in_a_drive(run: Run, picks: Path) -> None:
    code, out, _ = run("import", picks, "picks", "--gripper-starts", "open")
    assert code == 0
    assert "opened or closed 5 times" in " ".join(out.split())

    train = ("train", "--demonstrations", "picks", "--model", "scl", "--seeds", 1, "--epochs", 10)
    assert run(*train, "--context", "joints", "gripper")[0] == 0
    assert load_decoder("runs/picks-scl").layout.gripper == "action.gripper"

    drive = ("drive", "runs/picks-scl", "--drives", 1, "--jobs", 1, "--time-limit-s", 20)
    assert run(*drive, "--record", "driven")[0] == 0
    for episode in read_dataset("driven").episodes:
        told = episode.extras["action.gripper"][:, 0]
        width = episode.extras["observation.gripper_width"][:, 0]
        assert (told[0], told[-1], np.count_nonzero(np.diff(told))) == (np.float32(0.08), 0.0, 1)
        closing = int(np.argmin(told))
        # The fingers stay open until they are told to close, and follow within the safety filter's speed.
        assert (width[:closing] == np.float32(0.08)).all()
        assert (np.diff(width) >= -0.05 / 100 - 1e-6).all()
        assert width[-1] < 0.04

    # What was driven can be learned from in turn.
    assert context_layout(read_dataset("driven"), ("joints", "gripper")).gripper == "action.gripper"
