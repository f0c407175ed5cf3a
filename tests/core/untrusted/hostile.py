"""Files made to hang, crash or exhaust every reader, from seeds; and the command line run on each of them.

``python tests/untrusted/hostile.py [MOST] [READER ...]`` runs them and prints a table. Every command is run
in a forked child after the imports. Memory is the child's largest resident set, with all that is imported;
time is the processor's, so that a busy machine counts for nothing (what hangs is ended, and so refused by no
sentence).
"""

import io
import json
import os
import resource
import shutil
import signal
import sqlite3
import struct
import sys
import tempfile
import time
import traceback
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from latentarm.cli import main
from latentarm.demonstrations.dataset import write_dataset
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.robots import model_file  # noqa: F401 - MuJoCo is loaded before the children are forked
from latentarm.tasks.table_top import TableTop

SECONDS = 10
MEGABYTES = 512
RUNS_CODE = {"pickle.find_class", "os.system", "os.exec", "os.posix_spawn", "subprocess.Popen", "exec.file"}

Rng = np.random.Generator
Make = Callable[[Rng, Path], list[str]]
"""Makes one hostile file in a folder that holds the base (a run and its dataset); returns the command."""


@dataclass(frozen=True)
class Outcome:
    reader: str
    kind: str
    code: int
    said: str
    left: list[str]
    ran: list[str]
    seconds: float
    megabytes: float

    @property
    def faults(self) -> list[str]:
        found = []
        if self.code != 2:
            found.append(f"exit {self.code}")
        if self.said.count("\n") != 1 or not self.said.startswith("latentarm: "):
            found.append("not one sentence")
        if any(character < " " and character != "\n" for character in self.said):
            found.append("controls in the sentence")
        if self.left:
            found.append(f"left {self.left}")
        if self.ran:
            found.append(f"ran {self.ran}")
        if self.seconds > SECONDS:
            found.append(f"{self.seconds:.1f} s")
        if self.megabytes > MEGABYTES:
            found.append(f"{self.megabytes:.0f} MB")
        return found


def base(folder: Path) -> None:
    """A dataset, a run that was trained on it, and a profile of nobody."""
    child = os.fork()
    if not child:  # torch stays out of the process whose memory is measured
        from latentarm.runs.options import TrainOptions
        from latentarm.runs.training import train_run

        write_dataset(TableTop().demonstrate(4, np.random.default_rng(0)), folder / "table")
        train_run(TrainOptions((folder / "table",), "pca", out=folder / "run", seeds=1))
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0


def no_file(path: Path, rng: Rng) -> None:
    """Replace a file by something that is not a regular file."""
    shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
    kind = rng.integers(4)
    if kind == 0:
        os.mkfifo(path)
    elif kind == 1:
        path.symlink_to("/dev/zero")
    elif kind == 2:
        path.mkdir()
    else:
        path.symlink_to(path.name)


def cut(path: Path, rng: Rng) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: int(rng.integers(1, max(len(content) - 4, 2)))])


def garbage(path: Path, rng: Rng) -> None:
    path.write_bytes(rng.bytes(int(rng.integers(1, 5000))))


def hostile_json(path: Path, rng: Rng) -> None:
    """A document that is deep, huge, infinite, ambiguous or not text."""
    size = int(rng.integers(1000, 300_000))
    start = '{"a":'
    path.write_bytes(
        [
            (start * size).encode(),
            (start + "[" * size + "]" * size + "}").encode(),
            (start + "[" + "[]," * 2_000_000 + "1]}").encode(),
            b'{"a":1e999}',
            b'{"a":[-Infinity,NaN]}',
            b'{"a":1,"a":2}',
            (start + "9" * 4000 + "}").encode(),
            (start + '"' + "\\u0007" * 100_000 + '"}').encode(),
            b'{"a":"\\ud800"}',
            '{"a":1}'.encode("utf-16"),
            b'{"a":"\xff"}',
            b"[1]",
            b"",
            b"\x80\x04cos\nsystem\n(S'touch owned'\ntR.",
        ][rng.integers(14)]
    )


def wrong_values(path: Path, rng: Rng) -> None:
    """A document of the right fields, one of which is of another kind, absurd or full of escapes."""
    document = json.loads(path.read_text())
    places: list[tuple[dict, str]] = []
    waiting = [document]
    while waiting:
        section = waiting.pop()
        for key, value in section.items():
            if key in (
                "features",
                "fps",
                "total_episodes",
                "total_frames",
                "codebase_version",
                "data_files_size_in_mb",
                "demonstrations",
                "held_out",
                "kind",
                "fingerprint",
                "schema",
                "dimensions",
                "sha256",
                "seeds",
                "hidden",
                "latent",
                "context_dim",
                "training",
                "collapsed",
                "validation_loss",
            ):
                places.append((section, key))
            # No reader uses all parameters, and the commands here do not read the frame of a page's stick.
            if isinstance(value, dict) and key not in ("parameters", "frame"):
                waiting.append(value)
    section, key = places[rng.integers(len(places))]
    bad = [
        None,
        [],
        {},
        -1.5,
        "\x1b]0;owned\x07" + "x" * int(rng.integers(0, 60_000)),
        [[[[]]]],
        2**62,
        "a\0b",
    ]
    section[key] = bad[rng.integers(len(bad))]
    path.write_text(json.dumps(document))


def any_of(*ways: Callable[[Path, Rng], None]) -> Callable[[Path, Rng], str]:
    def change(path: Path, rng: Rng) -> str:
        way = ways[rng.integers(len(ways))]
        way(path, rng)
        return way.__name__

    return change


def changed(name: str, command: list[str], *ways: Callable[[Path, Rng], None]) -> Make:
    change = any_of(*ways)

    def make(rng: Rng, folder: Path) -> list[str]:
        path = next(iter(sorted(folder.glob(name))))
        return [*command, "#", change(path, rng)]

    return make


def parquet_bomb(path: Path, rng: Rng) -> None:
    table = pq.read_table(path)
    text = pa.array([["x" * 1_000_000] * int(rng.integers(100, 250))] * len(table))
    names = [name for name in table.column_names if name != "tasks"]
    bomb = (
        pa.table({**{name: table.column(name) for name in names}, "tasks": text.slice(0, len(table))})
        if len(table) < 100
        else table.append_column("tasks", pa.array(["x" * 1_000_000] * len(table)))
    )
    pq.write_table(bomb, path, compression="zstd")


def parquet_columns(path: Path, rng: Rng) -> None:
    pq.write_table(pa.table({f"c{index}": [0] for index in range(int(rng.integers(10_001, 11_000)))}), path)


def parquet_types(path: Path, rng: Rng) -> None:
    table = pq.read_table(path)
    name = "episode_index"
    table = table.set_column(table.column_names.index(name), name, pa.array([[["x"]]] * len(table)))
    pq.write_table(table, path)


def csv_file(rng: Rng, folder: Path) -> list[str]:
    path = folder / "in.csv"
    wide = int(rng.integers(2_000, 300_000))
    kinds = {
        "columns": "episode,timestamp," + ",".join(f"j{index}" for index in range(wide)) + "\n",
        "commas": "," * wide * 10,
        "one line": "x" * 5_000_000,
        "text without end": 'episode,timestamp,a\n0,0,"' + "\n" * 5_000_000,
        "fields in a record": "episode,timestamp,a\n0,0," + '"\n",' * 500_000,
        "episodes": "episode,timestamp,a\n" + "".join(f"{index},0,0\n" for index in range(150_000)),
        "no numbers": "episode,timestamp,a\n0,0,\x1b]0;owned\x07\n",
        "nul": "episode,timestamp,a\n0,0,\0\n",
        "huge": "episode,timestamp,a\n0,0,1e400\n0,1,1\n",
        "same name": "episode,timestamp,a,a\n",
    }
    kind = list(kinds)[rng.integers(len(kinds))]
    path.write_text(kinds[kind])
    return ["import", "in.csv", "out", "#", kind]


def npz_file(rng: Rng, folder: Path) -> list[str]:
    path = folder / "in.npz"
    count = int(rng.integers(100_000_000, 130_000_000))

    def member(shape: str, content: bytes, descr: str = "'<f8'") -> bytes:
        header = (
            f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(117) + b"\n"
        )
        return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + content

    kind = ["bomb", "lie", "objects", "members", "deep header", "cut", "negative", "none"][rng.integers(8)]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        if kind == "bomb":
            with archive.open("q.npy", "w", force_zip64=True) as stream:
                stream.write(member(f"({count // 7}, 7)", b""))
                for _ in range(count // 7 * 56 >> 20):
                    stream.write(bytes(1 << 20))
                stream.write(bytes((count // 7 * 56) & 0xFFFFF))
        elif kind == "objects":
            archive.writestr("q.npy", member("(1,)", b"\x80\x04cos\nsystem\n(S'touch owned'\ntR.", "'|O'"))
        elif kind == "members":
            for index in range(2000):
                archive.writestr(f"a{index}.npy", member("(1,)", bytes(8)))
        elif kind == "deep header":
            archive.writestr("q.npy", member("(" * 5000, b""))
        elif kind != "none":
            archive.writestr("q.npy", member({"negative": "(-1, 7)"}.get(kind, f"({count}, 7)"), bytes(56)))
    if kind == "cut":
        cut(path, rng)
    return ["import", "in.npz", "out", "#", kind]


def hdf5_file(rng: Rng, folder: Path) -> list[str]:
    path = folder / "in.hdf5"
    kind = [
        "chunk",
        "declared",
        "chunks",
        "soft loop",
        "external",
        "virtual",
        "object",
        "env",
        "cut",
        "types",
    ][rng.integers(10)]
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = '{"env_kwargs": {"control_freq": 20}}'
        obs = data.create_group("demo_0/obs")
        if kind == "chunk":
            rows = int(rng.integers(1 << 23, 1 << 24))
            obs.create_dataset(
                "joint_states", (10, 7), "f8", maxshape=(None, 7), chunks=(rows, 7), compression="gzip"
            )[0] = 1
        elif kind == "declared":
            obs.create_dataset("joint_states", (1 << int(rng.integers(24, 40)), 7), "f8", chunks=(64, 7))
        elif kind == "chunks":
            obs.create_dataset("joint_states", (1 << 20, 7), "f8", chunks=(1, 1))
        elif kind == "soft loop":
            obs["joint_states"] = h5py.SoftLink("/data/demo_0/obs/joint_states")
        elif kind == "external":
            obs["joint_states"] = h5py.ExternalLink("/etc/passwd", "/")
        elif kind == "virtual":
            layout = h5py.VirtualLayout((10, 7), "f8")
            layout[:] = h5py.VirtualSource("elsewhere.h5", "x", (10, 7))
            obs.create_virtual_dataset("joint_states", layout)
        elif kind == "object":
            obs.create_dataset("joint_states", (10, 7), h5py.special_dtype(vlen=str))
        elif kind == "types":
            obs.create_dataset("joint_states", (10,) * int(rng.integers(3, 7)), "f4")
        else:
            data.attrs["env_args"] = "[" * 30_000
            obs.create_dataset("joint_states", data=np.zeros((10, 7)))
    if kind == "cut":
        cut(path, rng)
    return ["import", "in.hdf5", "out", "#", kind]


def stl(folder: Path) -> None:
    (folder / "m.stl").write_bytes(bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(100))


def png(folder: Path, side: int) -> None:
    def chunk(kind: bytes, content: bytes) -> bytes:
        return (
            struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        )

    packed = zlib.compress(bytes(side + 1) * side, 9)
    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    (folder / "b.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")
    )


MJCF = (
    '<mujoco>{0}<worldbody><body name="a"><joint name="j" axis="0 0 1"/><geom size=".1"/>'
    '<body name="b"><joint name="k" axis="0 1 0"/><geom size=".1"/>{1}<site name="tool"/></body></body>'
    "</worldbody></mujoco>"
)


def mjcf_file(rng: Rng, folder: Path) -> list[str]:
    many = int(rng.integers(30_000, 2_000_000_000))
    stl(folder)
    os.mkfifo(folder / "pipe")
    kinds = {
        "entities": ("", ""),
        "copies": ("", f'<replicate count="{many}"><geom size=".1"/></replicate>'),
        "nested copies": ("", '<replicate count="1000">' * 5 + '<geom size=".1"/>' + "</replicate>" * 5),
        "keys": (f'<size nkey="{many}"/>', ""),
        "arena": ('<size memory="100G"/>', ""),
        "user": ('<size nuser_geom="2000000000"/>', ""),
        "texture": (
            f'<asset><texture type="2d" builtin="flat" width="{min(many, 40000)}" height="60000"/></asset>',
            "",
        ),
        "field": ('<asset><hfield name="h" nrow="40000" ncol="40000" size="1 1 1 1"/></asset>', ""),
        "pipe": ('<asset><mesh name="m" file="pipe"/></asset>', ""),
        "endless": ('<asset><mesh name="m" file="/dev/zero" content_type="model/stl"/></asset>', ""),
        "included pipe": ('<include file="pipe"/>', ""),
        "itself": ('<include file="in.xml"/>', ""),
        "attached": ('<asset><model name="s" file="in.xml"/></asset>', ""),
        "lying mesh": ('<asset><mesh name="m" file="m.stl"/></asset>', '<geom type="mesh" mesh="m"/>'),
        "picture": ('<asset><texture name="t" type="2d" file="b.png"/></asset>', ""),
        "deep": ("", "<body>" * 3000 + "</body>" * 3000),
        "elements": ("", '<geom size=".1"/>' * 30_000),
        "joints": (
            "",
            "".join('<body><joint axis="0 0 1"/><geom size=".1"/>' for _ in range(99))
            + '<site name="second"/>'
            + "</body>" * 99,
        ),
        "plugin": ('<extension><plugin plugin="evil.so"/></extension>', ""),
        "cut": ("", ""),
        "garbage": ("", ""),
    }
    kind = list(kinds)[rng.integers(len(kinds))]
    text = MJCF.format(*kinds[kind])
    if kind == "entities":
        text = '<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>' + text
    if kind == "picture":
        png(folder, 20_000)
    path = folder / "in.xml"
    path.write_text(text)
    if kind in ("cut", "garbage"):
        {"cut": cut, "garbage": garbage}[kind](path, rng)
    if kind == "joints":
        return ["robots", "in.xml", "--end-effector", "second", "#", kind]
    return ["robots", "in.xml", "#", kind]


def urdf_file(rng: Rng, folder: Path) -> list[str]:
    os.mkfifo(folder / "pipe.stl")
    stl(folder)
    mesh = {
        "pipe": "pipe.stl",
        "endless": "/dev/zero",
        "lying": "m.stl",
        "away": "package://x/../../../../etc/passwd",
    }
    kinds = [*mesh, "entities", "outside", "deep", "links", "speed", "cut", "garbage", "not a file", "xacro"]
    kind = kinds[rng.integers(len(kinds))]
    collision = f'<collision><geometry><mesh filename="{mesh.get(kind, "m.stl")}"/></geometry></collision>'
    speed = "1e999x" if kind == "speed" else "1"
    text = (
        f'<robot name="r"><link name="a"/><link name="b">{collision}</link><joint name="j" type="revolute">'
        f'<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
        f'<limit lower="-1" upper="1" velocity="{speed}"/>'
        "</joint>{0}</robot>"
    ).format(
        {
            "deep": "<x>" * int(rng.integers(200, 90_000)),
            "links": "".join(f'<link name="l{index}"/>' for index in range(30_000)),
            "xacro": "<xacro:include filename='/dev/zero'/>",
        }.get(kind, "")
    )
    if kind == "entities":
        text = '<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]>' + text
    if kind == "outside":
        text = '<!DOCTYPE r SYSTEM "file:///etc/passwd">' + text
    path = folder / "in.urdf"
    path.write_text(text)
    if kind in ("cut", "garbage", "not a file"):
        {"cut": cut, "garbage": garbage, "not a file": no_file}[kind](path, rng)
    return ["robots", "in.urdf", "#", kind]


def journal_file(rng: Rng, folder: Path) -> list[str]:
    path = folder / "in.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(EpisodeHeader("panda", ("a",), 10.0, "x"))
    recorder.end_episode()
    recorder.close()
    kind = [
        "view",
        "trigger",
        "blob",
        "about",
        "figures",
        "types",
        "cut",
        "garbage",
        "not a file",
        "wal",
        "other",
    ][rng.integers(11)]
    if kind in ("cut", "garbage", "not a file"):
        {"cut": cut, "garbage": garbage, "not a file": no_file}[kind](path, rng)
    elif kind == "wal":
        os.mkfifo(folder / "in.sqlite-wal")
    else:
        with sqlite3.connect(path) as database:
            database.execute("PRAGMA journal_mode = DELETE")
            size = int(rng.integers(1 << 21, 1 << 23))
            script = {
                "view": "DROP TABLE samples; CREATE VIEW samples AS WITH RECURSIVE c(episode, number,"
                " figures, stop, limited_by) AS (SELECT 1, 1, x'', '', ''"
                " UNION ALL SELECT 1, number + 1, x'', '', ''"
                " FROM c) SELECT * FROM c;",
                "trigger": "CREATE TRIGGER t AFTER INSERT ON samples BEGIN DELETE FROM episodes; END;",
                "blob": f"INSERT INTO samples VALUES (1, 0, zeroblob({size}), NULL, '');",  # noqa: S608
                "about": f"UPDATE episodes SET about = '{'[' * 100_000}';",  # noqa: S608
                "figures": "INSERT INTO samples VALUES (1, 0, zeroblob(100), NULL, '');",
                "types": "INSERT INTO samples VALUES (1, 0, 'text', 7, 7);",
                "other": "DROP TABLE samples;",
            }[kind]
            database.executescript(script)
        database.close()
    return ["export", "in.sqlite", "--out", "out", "#", kind]


READERS: dict[str, tuple[int, Make]] = {
    "run: config.json": (
        40,
        changed("run/config.json", ["drive", "run"], no_file, hostile_json, wrong_values, cut, garbage),
    ),
    "run: model.safetensors": (20, changed("run/model.safetensors", ["drive", "run"], no_file, cut, garbage)),
    "dataset: info.json": (
        35,
        changed(
            "table/meta/info.json", ["inspect", "table"], no_file, hostile_json, wrong_values, cut, garbage
        ),
    ),
    "dataset: episodes": (
        25,
        changed(
            "table/meta/episodes/*/*.parquet",
            ["inspect", "table"],
            no_file,
            parquet_bomb,
            parquet_columns,
            parquet_types,
            cut,
            garbage,
        ),
    ),
    "dataset: samples": (
        25,
        changed(
            "table/data/*/*.parquet",
            ["inspect", "table"],
            no_file,
            parquet_columns,
            parquet_types,
            cut,
            garbage,
        ),
    ),
    "CSV": (30, csv_file),
    "npz": (30, npz_file),
    "HDF5": (30, hdf5_file),
    "MJCF": (30, mjcf_file),
    "URDF": (20, urdf_file),
    "journal": (15, journal_file),
}


def run_one(reader: str, make: Make, seed: int, start: Path, place: Path) -> Outcome:
    """Make one hostile file in a copy of the base, and run the command on it in a child."""
    shutil.copytree(start, place)
    words = _made(make, seed, place)
    kind = words[words.index("#") + 1]
    command = words[: words.index("#")]
    before = _listing(place)
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as ran:
        began = time.monotonic()
        child = os.fork()
        if not child:
            _be_the_command(command, place, said.fileno(), ran.fileno())
        _, status, usage = os.wait4(child, 0)
        seconds = time.monotonic() - began
        said.seek(0)
        ran.seek(0)
        outcome = Outcome(
            reader=reader,
            kind=kind,
            code=os.waitstatus_to_exitcode(status),
            said=said.read().decode(errors="replace"),
            left=sorted(_listing(place) - before),
            ran=ran.read().decode().split(),
            seconds=min(seconds, usage.ru_utime + usage.ru_stime),
            megabytes=usage.ru_maxrss / 1024,
        )
    shutil.rmtree(place)
    return outcome


def _made(make: Make, seed: int, place: Path) -> list[str]:
    """Make the file in a child of its own: what that takes must not count as the reader's."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.write(writing, json.dumps(make(np.random.default_rng(seed), place)).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        words = json.load(stream)
    assert os.waitpid(child, 0)[1] == 0
    return words


def _be_the_command(command: list[str], place: Path, said: int, ran: int) -> None:
    code = 99
    try:
        signal.alarm(20 * SECONDS)  # a hang; the machine may be busy, so the bound is on its own time
        resource.setrlimit(resource.RLIMIT_CPU, (2 * SECONDS, 2 * SECONDS))
        os.chdir(place)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(said, 2)
        sys.stdout = io.TextIOWrapper(open(1, "wb", closefd=False))  # noqa: SIM115
        sys.stderr = io.TextIOWrapper(open(2, "wb", closefd=False), errors="backslashreplace")  # noqa: SIM115

        def watch(event: str, _: tuple[object, ...]) -> None:
            if event in RUNS_CODE:
                os.write(ran, event.encode() + b" ")

        sys.addaudithook(watch)
        code = main(command)
    except SystemExit as ended:
        code = int(ended.code or 0)
    except BaseException:  # noqa: BLE001 - what the interpreter would do
        traceback.print_exc()
        code = 1
    finally:
        sys.stderr.flush()
        os._exit(code)


def _listing(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def sweep(counts: dict[str, int], folder: Path) -> list[Outcome]:
    """So many files for each reader, seeded from 0."""
    (folder / "base").mkdir()
    if any(reader.startswith(("run", "dataset")) for reader in counts):
        base(folder / "base")
    return [
        run_one(reader, READERS[reader][1], seed, folder / "base", folder / "case")
        for reader, count in counts.items()
        for seed in range(count)
    ]


def table(outcomes: list[Outcome]) -> str:
    """Worst figures of each reader, as a GitHub table."""
    lines = ["| reader | files | refused | worst time (s) | worst memory (MB) |", "|---|---:|---:|---:|---:|"]
    for reader in dict.fromkeys(outcome.reader for outcome in outcomes):
        of_it = [outcome for outcome in outcomes if outcome.reader == reader]
        refused = sum(not outcome.faults for outcome in of_it)
        seconds, megabytes = (max(getattr(one, name) for one in of_it) for name in ("seconds", "megabytes"))
        lines.append(f"| {reader} | {len(of_it)} | {refused} | {seconds:.1f} | {megabytes:.0f} |")
    return "\n".join(lines)


def run_all(most: int, readers: list[str]) -> int:
    """So many files of each reader, all of these by default; the exit code says whether all were refused."""
    chosen = {
        reader: min(count, most) for reader, (count, _) in READERS.items() if not readers or reader in readers
    }
    with tempfile.TemporaryDirectory() as scratch:
        found = sweep(chosen, Path(scratch))
    sys.stdout.write(table(found) + "\n")
    faulty = [one for one in found if one.faults]
    for one in faulty:
        sys.stdout.write(f"{one.reader} | {one.kind} | {one.faults} | {one.said[-300:]!r}\n")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(run_all(int(sys.argv[1]) if len(sys.argv) > 1 else sys.maxsize, sys.argv[2:]))
