"""Writes small bags of ROS with the writers of rosbags."""

import shutil
from pathlib import Path

import numpy as np
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_typestore

JOINT_STATE = "sensor_msgs/msg/JointState"
START_NS = 1_700_000_000_000_000_000


def joint_state_bag(
    path: Path,
    names: list[str],
    positions: list[list[float]],
    topics: tuple[str, ...] = ("/joint_states",),
    alone: dict[str, float] | None = None,
    stamped: bool = True,
) -> Path:
    """A bag at 20 Hz, of the kind that its name says: ``.bag``, ``.db3``, ``.mcap``, or a folder of ROS 2.

    Args:
        path: where to.
        names: of the joints.
        positions: of each message.
        topics: all of them with the same messages.
        alone: joints that messages of their own tell of, in between.
        stamped: whether headers say when; else only the bag does.
    """
    first = path.suffix == ".bag"
    types = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    make = types.types[JOINT_STATE]
    header, time = types.types["std_msgs/msg/Header"], types.types["builtin_interfaces/msg/Time"]

    def message(number: int, said: dict[str, float]) -> bytes:
        stamp = divmod(START_NS + number * 50_000_000, 10**9) if stamped else (0, 0)
        place = {"seq": number} if first else {}
        values = np.array(list(said.values()))
        whole = make(
            header(stamp=time(*stamp), frame_id="", **place), list(said), values, np.zeros(0), np.zeros(0)
        )
        return (types.serialize_ros1 if first else types.serialize_cdr)(whole, JOINT_STATE)

    folder = path if first or not path.suffix else path.with_suffix("")
    storage = rosbag2.StoragePlugin.MCAP if path.suffix == ".mcap" else rosbag2.StoragePlugin.SQLITE3
    writer = rosbag1.Writer(path) if first else rosbag2.Writer(folder, version=9, storage_plugin=storage)
    with writer:
        connections = [writer.add_connection(topic, JOINT_STATE, typestore=types) for topic in topics]
        for number, values in enumerate(positions):
            at_ns = START_NS + number * 50_000_000
            for connection in connections:
                if alone:
                    writer.write(connection, at_ns, bytes(message(number, alone)))
                writer.write(connection, at_ns, bytes(message(number, dict(zip(names, values, strict=True)))))
    if first or not path.suffix:
        return path
    (file,) = folder.glob(f"*{path.suffix}")
    file.rename(path)
    shutil.rmtree(folder)
    return path
