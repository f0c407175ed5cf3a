"""Begins and ends the episodes of a drive."""

from dataclasses import dataclass
from typing import final

from latentarm.core.types import StepRecord
from latentarm.demonstrations.provenance import BY_HAND
from latentarm.web.arm_process.drive_setup import DriveSetup
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.page_inputs import PageInputs
from latentarm.web.arm_process.steering import Steering
from latentarm.web.arm_process.thing_poses import ThingPoses
from latentarm.web.protocol.orders import Record


@final
@dataclass(eq=False)
class Episodes:
    """An episode is one motion by one person: driven, or guided by hand."""

    _setup: DriveSetup
    _writer: EpisodeWriter
    _steering: Steering
    _inputs: PageInputs
    _thing_poses: ThingPoses

    def __post_init__(self) -> None:
        self._by_hand = False
        self._things: tuple[str, ...] = ()

    @property
    def by_hand(self) -> bool:
        """Whether an episode by hand is under way."""
        return self._writer.on and self._by_hand

    def begin(self, order: Record) -> None:
        self._steering.ending_episode = False
        if not self._writer.on:
            self._inputs.devices.clear()
            self._by_hand = order.by_hand
            self._things = self._thing_poses.begin()
        how = BY_HAND if order.by_hand else self._steering.mode
        self._writer.begin(self._setup.episode(self._things, how, order.task, order.person))

    def end(self) -> None:
        """End it now."""
        self._writer.end(", ".join(sorted(self._inputs.devices)))
        self._steering.ending_episode = False

    def follow(self, record: StepRecord, *, at_rest: bool) -> None:
        """Add a step; ``at_rest``: whether the arm's command is to stand still."""
        self._writer.add(record)
        if self._steering.ending_episode and at_rest:
            self.end()
