"""Export of recorded episodes to MCAP with the schemas of Foxglove, to look at them there."""

import json
import math
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.types import StepRecord
from latentarm.recordings.journal_reader import JournalEpisode
from latentarm.recordings.journal_writer import EpisodeHeader

_NUMBER: Final[dict[str, Any]] = {"type": "number"}
_NUMBERS: Final[dict[str, Any]] = {"type": "array", "items": _NUMBER}
_TEXT: Final[dict[str, Any]] = {"type": "string"}


def _object(title: str, /, **fields: Any) -> dict[str, Any]:
    named = {"title": title} if title else {}
    return {**named, "type": "object", "properties": fields}


_TIME: Final = _object("", sec={"type": "integer"}, nsec={"type": "integer"})
_JOINT: Final = _object("foxglove.JointState", name=_TEXT, position=_NUMBER, velocity=_NUMBER)
_TRANSFORM: Final = _object(
    "foxglove.FrameTransform",
    timestamp=_TIME,
    parent_frame_id=_TEXT,
    child_frame_id=_TEXT,
    translation=_object("", **dict.fromkeys("xyz", _NUMBER)),
    rotation=_object("", **dict.fromkeys("xyzw", _NUMBER)),
)
_STEP: Final = "latentarm.Step"
_SCHEMAS: Final = {
    "/joint_states": _object(
        "foxglove.JointStates", timestamp=_TIME, joints={"type": "array", "items": _JOINT}
    ),
    "/tf": _object("foxglove.FrameTransforms", transforms={"type": "array", "items": _TRANSFORM}),
    "/log": _object("foxglove.Log", timestamp=_TIME, level={"type": "integer"}, message=_TEXT, name=_TEXT),
    "/step": _object(
        _STEP,
        **dict.fromkeys(
            ("input", "latent", "action_human", "action_assist", "belief", "command", "gripper_m"), _NUMBERS
        ),
        **dict.fromkeys(("alpha", "pace"), _NUMBER),
        mode=_TEXT,
        limited_by=_TEXT,
        sightings={"type": "array", "items": _object("", thing=_TEXT, source=_TEXT, age_s=_NUMBER)},
    ),
}
"""By topic; `_STEP` is ours: what a step of the loop read and decided."""

_INFO: Final = 2
_WARNING: Final = 3  # levels of a foxglove.Log


def write_mcap(episodes: Sequence[JournalEpisode], out: Path) -> None:
    """Write episodes of `read_journal` to one file, each at the time at which it began.

    Poses of things are frames under ``base``; joints carry the commanded velocity. Raises UserError where
    the extra is not installed or the file cannot be written.
    """
    try:
        from mcap.writer import Writer
    except ModuleNotFoundError as error:
        raise UserError("MCAP needs a package: pip install 'latentarm[mcap]'.") from error
    with written_whole(out) as part, part.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="latentarm")
        channels: dict[str, int] = {}
        for topic, schema in _SCHEMAS.items():
            number = writer.register_schema(schema["title"], "jsonschema", json.dumps(schema).encode())
            channels[topic] = writer.register_channel(topic, "json", number)
        for number, episode in enumerate(episodes, start=1):
            header = episode.header
            about = {
                "task": header.task,
                "robot": header.robot,
                "settings": json.dumps(dict(header.settings)),
            }
            writer.add_metadata(f"episode {number}", about)
            for at_ns, topic, message in _messages(episode):
                writer.add_message(channels[topic], at_ns, json.dumps(message).encode(), at_ns)
        writer.finish()


def _messages(episode: JournalEpisode) -> Sequence[tuple[int, str, dict[str, Any]]]:
    """Times, ns since 1970, topics and messages."""
    header, records = episode.header, episode.records
    if not records:
        return []
    began = header.provenance.started_utc
    first_s = datetime.fromisoformat(began).replace(tzinfo=UTC).timestamp() if began else 0.0
    found: list[tuple[int, str, dict[str, Any]]] = []
    said = None
    for record in records:
        at_ns = round(1e9 * (first_s + record.time_s - records[0].time_s))
        stamp = {"sec": at_ns // 10**9, "nsec": at_ns % 10**9}
        if not math.isnan(record.state[0]):
            joints = zip(header.joint_names, record.state, record.command.velocity, strict=True)
            named = [{"name": name, "position": q, "velocity": dq} for name, q, dq in joints]
            found.append((at_ns, "/joint_states", {"timestamp": stamp, "joints": named}))
        if header.things:
            frames = [_frame(stamp, *one) for one in zip(header.things, record.things.tolist(), strict=True)]
            found.append((at_ns, "/tf", {"transforms": frames}))
        found.append((at_ns, "/step", _step(record, header)))
        stop = record.command.stop
        text = "enabled" if stop is None else stop.reason
        if text != said:
            said, level = text, _INFO if stop is None else _WARNING
            log = {"timestamp": stamp, "level": level, "message": text, "name": "latentarm"}
            found.append((at_ns, "/log", log))
    return found


def _frame(stamp: dict[str, int], name: str, pose: Sequence[float]) -> dict[str, Any]:
    """``pose``: x, y, z, m, and a quaternion w, x, y, z."""
    x, y, z, w, *turn = pose
    return {
        "timestamp": stamp,
        "parent_frame_id": "base",
        "child_frame_id": name,
        "translation": {"x": x, "y": y, "z": z},
        "rotation": {**dict(zip("xyz", turn, strict=True)), "w": w},
    }


def _step(record: StepRecord, header: EpisodeHeader) -> dict[str, Any]:
    gripper, modes = record.gripper, header.modes
    return {
        **{
            name: getattr(record, name).tolist()
            for name in ("input", "latent", "action_human", "action_assist", "belief")
        },
        "command": record.command.velocity.tolist(),
        "gripper_m": [] if gripper is None else [gripper.width_m],
        "alpha": record.alpha,
        "pace": record.pace,
        "mode": modes[record.mode] if record.mode < len(modes) else "",
        "limited_by": ",".join(record.command.limited_by),
        "sightings": [
            {"thing": thing, "source": (*header.sources, "")[int(source)], "age_s": age_s}
            for thing, (source, age_s) in zip(header.things, record.sightings.tolist(), strict=False)
        ],
    }
