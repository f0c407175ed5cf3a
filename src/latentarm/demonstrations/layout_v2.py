"""Reading the LeRobotDataset v2.0 and v2.1 layouts: a Parquet file for each episode, a list in JSON lines."""

from pathlib import Path
from typing import Any, Final

from latentarm.demonstrations.info import Info
from latentarm.demonstrations.reader import read_file
from latentarm.errors import UserError
from latentarm.types import Episode
from latentarm.untrusted.documents import MOST_BYTES, parse_object
from latentarm.untrusted.memory import bounded_memory
from latentarm.untrusted.opening import read_bytes

EPISODES_PATH: Final = Path("meta/episodes.jsonl")
DATA_PATTERN: Final = "data/chunk-{chunk:03d}/episode_{episode:06d}.parquet"


def read_episodes_v2(root: Path, info: Info) -> tuple[Episode, ...]:
    """Every episode with all its float features.

    Args:
        root: the dataset's folder.
        info: what its ``meta/info.json`` says.

    Raises:
        UserError: a file is missing, damaged or too large, or an episode is not all there.
    """
    path = root / EPISODES_PATH
    lines = read_bytes(path, MOST_BYTES).splitlines()
    if len(lines) != info.episodes:
        raise UserError(f"{path} is damaged: it lists {len(lines)} episodes and not {info.episodes}.")
    size = sum(file.lstat().st_size for file in root.glob("data/*/*.parquet"))
    with bounded_memory(str(root), size):
        return _read(root, info, lines)


def _read(root: Path, info: Info, lines: list[bytes]) -> tuple[Episode, ...]:
    path = root / EPISODES_PATH
    episodes: list[Episode] = []
    for number, line in enumerate(lines):
        length, task = _entry(parse_object(line, f"{path}, line {number + 1},"), number, path)
        if not 0 < length <= info.frames:
            raise UserError(f"{path} is damaged: episode {number} cannot have {length} samples.")
        name = DATA_PATTERN.format(chunk=number // info.chunk_files, episode=number)
        episodes += read_file(root / name, info, number, [length], [task])
    if sum(len(episode.timestamp) for episode in episodes) != info.frames:
        raise UserError(f"{path} is damaged: its episodes do not hold {info.frames} samples.")
    return tuple(episodes)


def _entry(entry: dict[str, Any], number: int, path: Path) -> tuple[int, str]:
    """Length and task of an episode."""
    length, tasks = entry.get("length"), entry.get("tasks")
    if entry.get("episode_index") != number or not isinstance(length, int) or not isinstance(tasks, list):
        raise UserError(f"{path} is damaged: line {number + 1} does not describe episode {number}.")
    return length, "; ".join(str(task) for task in tasks)
