"""The saved poses of everybody who drives, read once and written in a thread."""

import asyncio
from pathlib import Path
from typing import final

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Notice, notice_of
from latentarm.web.protocol.orders import PoseToGoTo
from latentarm.web.protocol.server_messages import Poses
from latentarm.web.records.people import People
from latentarm.web.records.poses import SavedPose, read_poses, with_pose, without_pose, write_poses


@final
class PoseBook:
    """Saved poses by person; guests share those in the folder ``shared``."""

    def __init__(self, people: People, shared: Path) -> None:
        self._people = people
        self._shared = shared
        self._known: dict[str | None, tuple[SavedPose, ...]] = {}
        self._problem: Notice | None = None
        self._writing: set[asyncio.Task[None]] = set()
        self._last = asyncio.Lock()
        self.number = 0

    def told(self, person: str | None, robot: str) -> Poses:
        """The message about a person's poses for a robot; guests are None."""
        names = tuple(one.name for one in self._of(person) if one.robot == robot)
        return Poses(names=names, problem=self._problem)

    def find(self, person: str | None, robot: str, name: str) -> PoseToGoTo | None:
        """A pose by its name; None where there is none."""
        for one in self._of(person):
            if one.robot == robot and one.name == name:
                return PoseToGoTo(name=one.name, q=one.q)
        return None

    def save(self, person: str | None, robot: str, name: str, q: tuple[float, ...]) -> None:
        """Save joint positions ``q``, (n,), rad; a failure is reported as the problem."""
        try:
            self._keep(person, with_pose(self._of(person), robot, name, q))
        except UserError as error:
            self._fail(error)

    def delete(self, person: str | None, robot: str, name: str) -> None:
        self._keep(person, without_pose(self._of(person), robot, name))

    async def settled(self) -> None:
        """Wait until everything is on disk."""
        await asyncio.gather(*self._writing)

    def _of(self, person: str | None) -> tuple[SavedPose, ...]:
        if person not in self._known:
            try:
                self._known[person] = read_poses(self._folder(person))
            except UserError as error:
                self._known[person] = ()
                self._fail(error)
        return self._known[person]

    def _folder(self, person: str | None) -> Path:
        return self._shared if person is None else self._people.folder_of(person)

    def _fail(self, error: UserError) -> None:
        self._problem = notice_of(error)
        self.number += 1

    def _keep(self, person: str | None, poses: tuple[SavedPose, ...]) -> None:
        self._known[person] = poses
        self._problem = None
        self.number += 1
        task = asyncio.create_task(self._write(person, poses))
        self._writing.add(task)
        task.add_done_callback(self._writing.discard)

    async def _write(self, person: str | None, poses: tuple[SavedPose, ...]) -> None:
        async with self._last:
            try:
                if person is None or self._people.find(person) is not None:
                    await asyncio.to_thread(write_poses, self._folder(person), poses)
            except UserError as error:
                self._fail(error)
