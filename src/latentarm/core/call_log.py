"""Records every call of a `Step` in an incident file: arguments and answer."""

import hashlib
import json
import sys
import zlib
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import wraps
from pathlib import Path
from typing import Any, Concatenate, Final, ParamSpec, Protocol, TypeVar, cast, final

from latentarm.core.errors import UserError
from latentarm.core.exact_json import to_json
from latentarm.core.journal_limits import JournalLimits, JournalWatch
from latentarm.core.types import Command, FloatArray, StepRecord, Stop
from latentarm.core.untrusted.documents import parse_object
from latentarm.core.untrusted.opening import opened

MOST_FILE_BYTES: Final = 256 << 20  # a longer file takes no more calls

_GZIP: Final = 31
_FLUSHED: Final = b"\0\0\xff\xff"
_MOST_FLUSHED: Final = 1 << 28
_CHECK_EVERY: Final = 100
_MOST_WAITING: Final = 6000
_P = ParamSpec("_P")
_R = TypeVar("_R")


@final
class CallLog:
    """Writes calls to a file in a thread of its own, so that the loop never waits for the disk.

    The file is gzip of one JSON document a line, each after a digest of all lines so far. It can be read up
    to the last flush at any time. When it cannot be written any more, the log says so once on standard error.
    In sentences, such as the arm's own words, ``hidden`` (an address) is left out.
    """

    def __init__(
        self, path: Path, limits: JournalLimits, head: Sequence[dict[str, Any]], hidden: str = ""
    ) -> None:
        self._hidden = hidden
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("xb", buffering=0)
        self._watch = JournalWatch(path, limits)
        self._large_bytes = limits.most_bytes // 4
        self._packing, self._digest = zlib.compressobj(wbits=_GZIP), ""
        self._writer = ThreadPoolExecutor(1, "incident")
        self._asked = self._written = 0
        self._lost = self._inside = self.large = False
        self._seen: list[Any] = []
        self._lines = list(head)
        self.flush()

    def watched(self, surroundings: Callable[[], FloatArray] | None) -> Callable[[], FloatArray] | None:
        """Wrap the surroundings of a `Step`, so that a call records the poses that it reads."""
        if surroundings is None:
            return None

        def look() -> FloatArray:
            poses = surroundings()
            self._seen.append(to_json(poses))
            return poses

        return look

    def call(self, name: str, given: Sequence[object], made: Callable[[], _R]) -> _R:
        """Make a call and record it; a call within another one belongs to the outer one."""
        if self._inside:
            return made()
        self._inside, self._seen = True, []
        # Before the call: a driver may use its arrays again.
        line: dict[str, Any] = {"call": name, "given": [_noted(one) for one in given], "seen": self._seen}
        try:
            result = made()
            line["answer"] = result.command if isinstance(result, StepRecord) else result
            return result
        finally:
            # Surroundings that are read between calls belong to no call.
            self._inside, self._seen = False, []
            self._lines.append(line)

    def flush(self) -> None:
        """Queue the calls so far for writing, without waiting."""
        lines, self._lines = self._lines, []
        if self._asked - self._written > _MOST_WAITING:
            self._lose("the disk is too slow")
        if lines and not self._lost:
            self._asked += 1
            self._writer.submit(self._write, lines)

    def close(self) -> None:
        """Write the remaining calls and a mark that the file is complete."""
        self._lines.append({"complete": True})
        self.flush()
        self._writer.shutdown()
        self._file.close()

    def _lose(self, why: str) -> None:
        if not self._lost:
            sys.stderr.write(f"latentarm: the incident file {self._file.name} ends here: {why}.\n")
        self._lost = True

    def _write(self, lines: Sequence[dict[str, Any]]) -> None:
        try:
            if self._written % _CHECK_EVERY == 0:
                self._watch.check()
            for line in lines:
                line["answer"] = answer_of(line.get("answer"))
                text = json.dumps(line, separators=(",", ":"))
                if self._hidden and self._hidden in text:
                    text = json.dumps(_hiding(line, self._hidden), separators=(",", ":"))
                self._digest = _digest(self._digest, text)
                self._file.write(self._packing.compress(f"{self._digest} {text}\n".encode()))
            self._file.write(self._packing.flush(zlib.Z_SYNC_FLUSH))
            self._written += 1
            self.large = self._file.tell() > self._large_bytes
        except (OSError, UserError) as error:
            self._lose(str(error))


class _Logged(Protocol):
    @property
    def calls(self) -> CallLog | None: ...


_S = TypeVar("_S", bound=_Logged)


def logged(method: Callable[Concatenate[_S, _P], _R]) -> Callable[Concatenate[_S, _P], _R]:
    """Decorate a method so that its object's ``calls`` records each call."""

    @wraps(method)
    def recorded(self: _S, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        if self.calls is None:
            return method(self, *args, **kwargs)
        given = (*args, *kwargs.values())
        return self.calls.call(method.__name__, given, lambda: method(self, *args, **kwargs))

    return recorded


def answer_of(result: object) -> Any:
    """The decision of a call: a command, or why the arm may not move, with its code and in words."""
    if isinstance(result, StepRecord):
        return answer_of(result.command)
    if isinstance(result, Command):
        return {**to_json(result)["fields"], "stop": answer_of(result.stop)}
    return {"code": result.code, "reason": result.reason} if isinstance(result, Stop) else None


def _hiding(value: Any, hidden: str) -> Any:
    """A document without ``hidden`` in its sentences; a word alone is a name or a code."""
    match value:
        case str() if " " in value:
            return value.replace(hidden, "...")
        case dict():
            return {key: _hiding(one, hidden) for key, one in cast(dict[str, Any], value).items()}
        case list():
            return [_hiding(one, hidden) for one in cast(list[Any], value)]
        case _:
            return value


def _noted(value: object) -> Any:
    try:
        return to_json(value)
    except Exception:  # noqa: BLE001 - whatever an interface gives, recording it stops no arm
        return None


def read_calls(path: Path) -> Generator[dict[str, Any]]:
    """The lines of an incident file; a last one that was cut off is left out."""
    unpacking, part, rest, digest, number, vain = zlib.decompressobj(_GZIP), b"", b"", "", 0, 0
    with opened(path, 2 * MOST_FILE_BYTES) as file:
        while chunk := file.read(1 << 20):
            # Each flush ends in whole lines: after one that does not, the rest only looks cut off.
            *flushes, part = (part + chunk).split(_FLUSHED)
            for flushed in flushes:
                try:
                    content = unpacking.decompress(flushed + _FLUSHED, _MOST_FLUSHED)
                except zlib.error as error:
                    raise UserError(_damaged(path, number)) from error
                *lines, rest = (rest + content).split(b"\n")
                vain = 0 if lines else vain + 1
                if vain > 1 or unpacking.unconsumed_tail:
                    raise UserError(_damaged(path, number))
                for line in lines:
                    said, _, text = line.partition(b" ")
                    digest = _digest(digest, text.decode(errors="replace"))
                    if said != digest.encode():
                        raise UserError(_damaged(path, number))
                    number += 1
                    yield parse_object(text, f"{path}, line {number}")
            if len(part) > _MOST_FLUSHED:
                raise UserError(_damaged(path, number))
    if not number:
        raise UserError(_damaged(path, 0))


def _digest(before: str, text: str) -> str:
    return hashlib.sha256(f"{before}{text}".encode()).hexdigest()[:16]


def _damaged(path: Path, lines: int) -> str:
    what = f"is damaged after line {lines}: copy it again" if lines else "is not an incident file"
    return f"{path} {what}; `latentarm teleop` writes them to incidents/ in its --out."
