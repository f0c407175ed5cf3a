"""Recording a drive without keeping the control loop waiting for the disk."""

import threading
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from queue import Empty, Full, Queue
from typing import Final, final

from latentarm.control.recorder import EpisodeHeader, Recorder
from latentarm.errors import UserError
from latentarm.types import StepRecord
from latentarm.web.channel import Recording

_MOST_WAITING: Final = 6000
"""Samples that may wait for the disk: a minute of them."""

_CLOSE: Final = "close"


@final
@dataclass(frozen=True)
class _End:
    """The episode ends; with which kinds of input device it was driven."""

    device: str


@final
class EpisodeWriter:
    """Writes episodes to a journal in a thread of its own; its callers never wait.

    The journal is made when the first episode begins. An episode that the disk cannot keep up with is
    left incomplete and so never becomes part of a dataset.

    Args:
        folder: where journals go.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / f"journal-{datetime.now():%Y%m%d-%H%M%S}.sqlite"
        self._waiting: Queue[StepRecord | EpisodeHeader | _End | str] = Queue(_MOST_WAITING)
        self._thread: threading.Thread | None = None
        self._on = False
        self._samples = 0
        self._episodes = 0
        self._problem: str | None = None

    @property
    def on(self) -> bool:
        """Whether an episode is under way."""
        return self._on

    @property
    def status(self) -> Recording | None:
        """What is recorded; None where nothing ever was."""
        if self._thread is None:
            return None
        return Recording(
            on=self._on,
            samples=self._samples,
            episodes=self._episodes,
            problem=self._problem,
            journal=str(self._path),
        )

    def begin(self, header: EpisodeHeader) -> None:
        """Begin an episode, where none is under way."""
        if self._on:
            return
        # Before the thread begins: it may find at once that nothing can be written.
        self._problem = None
        self._on, self._samples = True, 0
        self._put(header)
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._write, name="recording", daemon=True)
            self._thread.start()

    def add(self, record: StepRecord) -> None:
        """Keep a step, where an episode is under way."""
        if self._on:
            self._samples += 1
            self._put(record)

    def end(self, device: str = "") -> None:
        """End the episode, where one is under way.

        Args:
            device: kind of input device that it was driven with.
        """
        if self._on:
            self._on = False
            self._put(_End(device))

    def close(self) -> None:
        """Write what is waiting and close the journal; an episode under way stays incomplete."""
        if self._thread is not None:
            self._put(_CLOSE)
            self._thread.join(timeout=5.0)

    def _put(self, item: StepRecord | EpisodeHeader | _End | str) -> None:
        try:
            self._waiting.put_nowait(item)
        except Full:
            self._break_off("The disk cannot keep up with the recording: the episode was broken off.")

    def _break_off(self, problem: str) -> None:
        self._on = False
        self._problem = problem

    def _write(self) -> None:
        try:
            recorder = Recorder(self._path)
            try:
                while (item := self._waiting.get()) != _CLOSE:
                    self._handle(recorder, item)
            finally:
                recorder.close()
        except UserError as error:
            self._break_off(str(error))
            while True:
                try:
                    self._waiting.get_nowait()
                except Empty:
                    return

    def _handle(self, recorder: Recorder, item: StepRecord | EpisodeHeader | _End | str) -> None:
        if isinstance(item, StepRecord):
            recorder.record(item)
        elif isinstance(item, EpisodeHeader):
            recorder.begin_episode(item)
        elif isinstance(item, _End) and self._problem is None:
            recorder.end_episode(item.device)
            self._episodes += 1
