"""Recording a drive without making the control loop wait for the disk."""

import math
import threading
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from functools import partial
from itertools import chain, count
from pathlib import Path
from queue import Empty, Full, Queue
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.journal_limits import JournalFullError, JournalLimits, JournalLostError
from latentarm.core.types import FloatArray, StepRecord, Stop
from latentarm.core.untrusted.terminal import one_line
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.web.protocol.notice import Notice, notice_of_stop
from latentarm.web.protocol.report import Recording

STILL_RAD: Final = 0.01
"""An arm that stays this close to its first position has not moved, rad (m for a slide)."""

_MOST_WAITING: Final = 6000  # samples that may wait for the disk: a minute
_CHECK_S: Final = 1.0
_Work = Callable[[Recorder], object]


@final
class EpisodeWriter:
    """Writes episodes to a journal in a separate thread, so that callers never wait.

    The journal is created when the first episode begins, and again if it was lost. If the disk cannot keep
    up, the episode stays incomplete and never becomes part of a dataset. An episode ends before the arm's
    readings become untrustworthy, and when the journal is full; both are complete. An episode without motion
    is not kept; in shadow mode the commands count as motion.
    """

    def __init__(self, folder: Path, limits: JournalLimits | None = None) -> None:
        self._folder = folder
        self._limits = limits
        self._path = self._new_path()
        self._untrusted: Stop | None = None
        self._waiting: Queue[_Work | None] = Queue(_MOST_WAITING)  # None closes the journal
        self._thread: threading.Thread | None = None
        self.on = False  # whether an episode is under way
        self._samples = 0
        self._first: FloatArray | None = None
        self._moved = self._shadow = False
        self._episodes = 0
        self._problem: Notice | None = None
        self._lost = False

    @property
    def status(self) -> Recording | None:
        """The recording; None if nothing was ever recorded."""
        if self._thread is None:
            return None
        return Recording(on=self.on, samples=self._samples, episodes=self._episodes, problem=self._problem)

    @property
    def journal(self) -> str | None:
        """Path of the journal that is or was last recorded to; None if nothing was ever recorded."""
        return None if self._thread is None else str(self._path)

    def begin(self, header: EpisodeHeader) -> None:
        """Begin an episode, unless one is under way."""
        if self.on:
            return
        # Before the thread starts: it may fail to write at once.
        self._problem = None
        if self._lost:
            self._lost, self._path, self._episodes = False, self._new_path(), 0
        self.on, self._samples = True, 0
        self._first, self._moved, self._shadow = None, False, header.provenance.shadow
        self._put(lambda recorder: recorder.begin_episode(header))
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._write, name="recording", daemon=True)
            self._thread.start()

    def add(self, record: StepRecord) -> None:
        """Keep a step of the episode under way; an untrustworthy one ends it."""
        stop = record.command.stop
        untrusted = stop if stop is not None and stop.untrusted else None
        # The reason stays until the arm is enabled again; only a new one ends an episode.
        news, self._untrusted = untrusted is not self._untrusted, untrusted
        if not self.on:
            return
        if (untrusted is not None and news) or math.isnan(record.state[0]):
            self.end()
            if stop is None:
                self._problem = Notice(code="joints_unreadable")
            else:
                why = notice_of_stop(stop)
                because = {**why.parameters, "because": why.code}
                self._problem = Notice(code="recording_ended", parameters=because)
        else:
            self._samples += 1
            self._first = record.state if self._first is None else self._first
            turned = np.abs(record.state - self._first).max()
            self._moved |= bool(turned > STILL_RAD) or record.command.gripper is not None
            self._moved |= self._shadow and bool(record.command.velocity.any())
            self._put(lambda recorder: recorder.recording and recorder.record(record))

    def end(self, device: str = "") -> None:
        """End the episode, if one is under way; ``device``: kind of input device that it was driven with."""
        if not self.on:
            return
        if self._moved:
            self.on = False
            self._put(partial(self._end_episode, device))
        else:
            self._put(Recorder.drop_episode)
            self._break_off(Notice(code="recording_still"))

    def close(self) -> None:
        """Write what is waiting and close the journal; an episode under way stays incomplete."""
        if self._thread is not None:
            self._put(None)
            self._thread.join(timeout=5.0)

    def _put(self, work: _Work | None) -> None:
        try:
            self._waiting.put_nowait(work)
        except Full:
            self._break_off(Notice(code="disk_too_slow"))

    def _break_off(self, problem: Notice) -> None:
        self.on = False
        self._problem = problem

    def _write(self) -> None:
        try:
            recorder = Recorder(self._path, self._limits)
            try:
                while (work := self._next()) is not None:
                    try:
                        work(recorder)
                    except JournalFullError as error:
                        self._episodes += error.ended_episode
                        if self.on:
                            self._break_off(_notice_of(error))
            finally:
                recorder.close()
        except UserError as error:
            self._lost = isinstance(error, JournalLostError)
            self._break_off(_notice_of(error))
            with suppress(Empty):
                while True:
                    self._waiting.get_nowait()

    def _next(self) -> _Work | None:
        """The next work; a check of the journal if there is none for a while."""
        try:
            return self._waiting.get(timeout=_CHECK_S)
        except Empty:
            return Recorder.check

    def _end_episode(self, device: str, recorder: Recorder) -> None:
        if recorder.recording:
            recorder.end_episode(device)
            self._episodes += 1

    def _new_path(self) -> Path:
        named = f"journal-{datetime.now():%Y%m%d-%H%M%S}"
        names = chain([named], (f"{named}-{number}" for number in count(2)))
        return next(path for name in names if not (path := self._folder / f"{name}.sqlite").exists())


def _notice_of(error: UserError) -> Notice:
    if isinstance(error, JournalLostError):
        return Notice(code="journal_lost")
    if isinstance(error, JournalFullError):
        return Notice(code="disk_full" if error.disk else "journal_full")
    return Notice(code="journal_unwritable", parameters={"text": one_line(str(error))})
