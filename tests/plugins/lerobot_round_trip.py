"""From an SO-101 dataset of LeRobot to driving, and back through LeRobot's own tools.

    python lerobot_round_trip.py OUT MODEL

MODEL is that of an SO-101. It runs in an environment with LeRobot 0.6, latentarm and
`lerobot_robot_latentarm` (`make lerobot`). Demonstrations and person are scripted, the arm is simulated.

1. LeRobot's writer makes a dataset as its SO-101 records it: degrees, the jaw from 0 to 100, commanded
   positions, a video.
2. `latentarm import`, `train` and `drive --arm mujoco`.
3. `lerobot-record` drives the trained run with a stick; `lerobot-replay` replays an episode;
   `lerobot-dataset-viz` shows it; `lerobot-edit-dataset` describes the dataset and deletes an episode.
4. `latentarm import`, `train` and `drive` on what was recorded there.
5. `lerobot-record` once more, with our driver of the SO-101 and simulated servos behind a serial port.

OUT/figures.json has all figures.
"""

import json
import os
import struct
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

os.environ.setdefault("HF_HUB_OFFLINE", "1")
os.environ.setdefault("HF_DATASETS_OFFLINE", "1")

import numpy as np
from latentarm_process.client import DrivingProcess, Seen
from lerobot.datasets import LeRobotDataset
from lerobot.scripts import lerobot_dataset_viz, lerobot_edit_dataset, lerobot_record, lerobot_replay

from latentarm.cli import main as latentarm
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.importers.importing import import_demonstrations
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import read_limits
from latentarm.robots.robot import Robot
from latentarm.tasks.reach import Reach

sys.path.insert(0, str(Path(__file__).parents[1]))
from arms.feetech_bus import FeetechBus

LIMITS = Path(__file__).parents[2] / "docs/your-arm/so101_limits.toml"
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


def tool(run: Callable[[], object], *arguments: str) -> None:
    """Run one of LeRobot's commands, here, so that LeRobot is imported once."""
    before, sys.argv = sys.argv, ["lerobot", *arguments]
    try:
        run()
    finally:
        sys.argv = before


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


def reached(run: Path) -> dict[str, object]:
    """How `latentarm drive` in MuJoCo ends along held-out episodes, steered by a simulated person."""
    rows = ours("drive", str(run), "--arm", "mujoco", "--drives", "1", "--out", f"{run}-drives")
    kept = ("success_rate", "time_s", "final_distance")
    return {
        str(row["measure"]): {key: row[key] for key in ("mean", "sd", "n", "unit")}
        for row in rows
        if row["measure"] in kept
    }


def record(dataset: Path, driven: tuple[str, ...], episodes: int, seconds: int) -> None:
    """Let a scripted person drive a run with `lerobot-record`."""
    stick = dataset.with_name(f"{dataset.name}-stick")
    person = Person(stick)
    tool(
        lerobot_record.main,
        *driven,
        "--teleop.type=latentarm_stick",
        f"--teleop.device={stick}",
        f"--dataset.repo_id=local/{dataset.name}",
        f"--dataset.root={dataset}",
        "--dataset.single_task=move about",
        f"--dataset.num_episodes={episodes}",
        f"--dataset.episode_time_s={seconds}",
        "--dataset.reset_time_s=2",
        "--dataset.push_to_hub=false",
        "--play_sounds=false",
    )
    person.leave()


def record_by_servos(dataset: Path, driven: tuple[str, ...], joints: tuple[str, ...]) -> None:
    """The same with our driver of the SO-101, LeRobot's class of it, and simulated servos."""
    calibration = dataset.with_name("servos.json")
    ranges = {"drive_mode": 0, "homing_offset": 0, "range_min": 1000, "range_max": 3000}
    motors = {name: {"id": index + 1, **ranges} for index, name in enumerate((*joints, "gripper"))}
    calibration.write_text(json.dumps(motors))
    with FeetechBus() as bus:
        address = f"lerobot://so101_follower?port={bus.port}&calibration={calibration}"
        record(dataset, (*driven, f"--robot.arm={address}"), episodes=2, seconds=8)


def states(dataset: Path, joints: int) -> FloatArray:
    """(T, n), what the first episode recorded through the plug-in says of the joints, rad."""
    found = LeRobotDataset(f"local/{dataset.name}", root=dataset, episodes=[0])
    return np.array([found[index]["observation.state"][:joints].numpy() for index in range(found.num_frames)])


def refusal(dataset: Path, robot: Robot) -> str:
    """What an import says that is told no unit."""
    try:
        import_demonstrations(dataset, robot)
    except UserError as error:
        return str(error).replace(str(dataset), dataset.name)
    return ""


@contextmanager
def watched() -> Iterator[list[Seen]]:
    """What the driving process sees, each time that LeRobot asks."""
    seen: list[Seen] = []
    look = DrivingProcess.look

    def watch(process: DrivingProcess) -> Seen:
        seen.append(look(process))
        return seen[-1]

    DrivingProcess.look = watch
    try:
        yield seen
    finally:
        DrivingProcess.look = look


def train(data: Path, run: Path) -> None:
    """Train one model on joints and gripper."""
    options = ("--seeds", "1", "--context", "joints", "gripper", "--epochs", "5")
    ours("train", "--demonstrations", str(data), *options, "--out", str(run))


def main() -> None:
    """Do it all, in OUT."""
    out, model = Path(sys.argv[1]).resolve(), sys.argv[2]
    out.mkdir(parents=True)
    os.environ.setdefault("HF_HOME", str(out / "home"))
    robot = load_robot(model, None, read_limits(LIMITS))
    figures: dict[str, Any] = {}
    stated = ("--robot", model, "--limits", str(LIMITS))
    so101, recorded = out / "so101", out / "recorded"
    first, second = out / "so101-run", out / "recorded-run"

    write_so101(so101, robot, 6)
    figures["refused without a unit"] = refusal(so101, robot)
    ours("import", str(so101), str(out / "so101-imported"), *stated, "--units", "deg")
    train(out / "so101-imported", first)
    figures["driven from the SO-101 dataset"] = reached(first)

    driven = ("--robot.type=latentarm", f"--robot.run={first}")
    in_mujoco = (*driven, "--robot.arm=mujoco")
    record(recorded, in_mujoco, episodes=4, seconds=5)
    with watched() as seen:
        dataset = ("--dataset.repo_id=local/recorded", f"--dataset.root={recorded}", "--dataset.episode=0")
        tool(lerobot_replay.main, *in_mujoco, *dataset, "--play_sounds=false")
    was = states(recorded, robot.dof)
    apart = np.abs(was - np.array([one.q for one in seen[-len(was) :]]))
    figures["replay"] = {
        "frames": len(was),
        "joints moved, rad": float(np.ptp(was, axis=0).max()),
        "apart, most, rad": float(apart.max()),
    }
    kept = ("--repo_id=local/recorded", f"--root={recorded}")
    tool(
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
    tool(lerobot_edit_dataset.main, *kept, "--operation.type=info")
    tool(
        lerobot_edit_dataset.main,
        *kept,
        "--new_repo_id=local/edited",
        f"--new_root={out / 'edited'}",
        "--operation.type=delete_episodes",
        "--operation.episode_indices=[0]",
    )

    ours("import", str(out / "edited"), str(out / "edited-imported"), *stated)
    figures["episodes imported"] = len(read_dataset(out / "edited-imported").episodes)
    train(out / "edited-imported", second)
    figures["driven from what was recorded"] = reached(second)
    by_servos = out / "by-servos"
    record_by_servos(by_servos, driven, robot.joint_names)
    moved = np.ptp(states(by_servos, robot.dof), axis=0)
    figures["recording by servos"] = {"joints moved, rad": moved.round(3).tolist()}
    (out / "figures.json").write_text(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
