"""Importing ROS 1 bags, ROS 2 bags (SQLite and MCAP) and MCAP files: each is one episode.

Only topics of ``sensor_msgs/JointState`` are read, by the message definition of `rosbags`: definitions in the
file would become code. Only the file itself is opened, none that a bag's ``metadata.yaml`` names.
"""

import struct
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.core.untrusted.opening import check_file
from latentarm.demonstrations.bounds import MAX_COLUMNS, MAX_FILE_BYTES, check_values
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.timing import typical_rate_hz

ROS1: Final = b"#ROSBAG V"
MCAP: Final = b"\x89MCAP"  # first bytes of these files
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
_DAMAGE: Final = (ArithmeticError, AssertionError, EOFError, LookupError, OSError, RuntimeError, struct.error)
"""Raised by damaged files, besides `TypeError`, `ValueError` and the errors of the libraries."""


def read_bag(files: Sequence[Path], options: ImportOptions) -> SourceData:
    """Read the joints' positions from the files of one recording, in order.

    A topic may report some joints in some messages and others in others, as where arm and gripper have their
    own drivers. Every message of the largest kind is a sample, completed with the latest values of the other
    joints. By default the rate is the timestamps' and the task the file's name.
    """
    source = files[0]
    messages = [message for file in files for message in _messages(file, options.topic)]
    names = list(dict.fromkeys(name for _, positions in messages for name in positions))
    if not names or len(names) > MAX_COLUMNS:
        raise UserError(f"{source} tells of {len(names)} joints; there must be 1 to {MAX_COLUMNS:,}.")
    kinds = Counter(frozenset(positions) for _, positions in messages)
    main = max(kinds, key=lambda kind: (len(kind), kinds[kind]))
    latest = dict[str, float]()
    times, rows = list[float](), list[list[float]]()
    for time_s, positions in messages:
        latest |= positions
        if positions.keys() == main and len(latest) == len(names):
            times.append(time_s)
            rows.append([latest[name] for name in names])
            check_values(source, "its topic", len(rows) * len(names))
    if not rows:
        raise UserError(f"{source} never tells of all of {', '.join(names[:20])}.")
    stamps: FloatArray = np.array(times)
    episode = Episode(np.array(rows), stamps - stamps[0], task=options.instruction or source.stem)
    rate = options.rate_hz or typical_rate_hz([episode])
    return SourceData(Demonstrations((episode,), rate, tuple(names)), "bag of ROS", in_rad=True)


def _messages(source: Path, topic: str | None) -> list[tuple[float, dict[str, float]]]:
    """Times, s, and positions by joint."""
    check_file(source, MAX_FILE_BYTES)
    try:
        import apsw
        from rosbags import rosbag1, rosbag2, serde, typesys
        from rosbags.rosbag2.storage_mcap import zstd
    except ModuleNotFoundError as error:
        raise UserError(f"{source} is a bag of ROS: pip install 'latentarm[bags]' to read it.") from error
    first = source.suffix == ".bag"
    store = typesys.Stores.ROS1_NOETIC if first else typesys.Stores.ROS2_HUMBLE
    unreadable = (rosbag1.ReaderError, rosbag2.ReaderError, serde.SerdeError)
    try:
        with rosbag1.Reader(source) if first else rosbag2.Reader(source) as reader:
            types = typesys.get_typestore(store)
            read = types.deserialize_ros1 if first else types.deserialize_cdr
            messages = reader.messages(_connections(reader.connections, topic, source))
            return [_positions(read(raw, JOINT_STATE), at_ns, source) for _, at_ns, raw in messages]
    except (*_DAMAGE, *unreadable, apsw.Error, zstd.ZstdError) as error:
        raise UserError(f"{source} is not a whole bag of ROS; it is truncated or damaged.") from error


def _connections(connections: Sequence[Any], topic: str | None, source: Path) -> list[Any]:
    topics = sorted({one.topic for one in connections if one.msgtype == JOINT_STATE})
    if (topic is not None and topic not in topics) or (len(topics) != 1 and topic is None):
        told = f"has these topics of {JOINT_STATE}: {', '.join(topics) or 'none'}"
        raise UserError(f"{source} {told}" + ("; choose one with --topic." if topics else "."))
    return [one for one in connections if one.topic == (topic or topics[0])]


def _positions(message: Any, received_ns: int, source: Path) -> tuple[float, dict[str, float]]:
    names, values = list(message.name), message.position.tolist()
    if len(names) != len(values) or len(set(names)) != len(names):
        raise UserError(f"{source}: a message has {len(values)} positions for the joints {', '.join(names)}.")
    stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
    return (stamp_ns or received_ns) * 1e-9, dict(zip(names, values, strict=True))
