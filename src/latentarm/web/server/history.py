"""Logs every drive, and writes it to the disk."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Notice, notice_of
from latentarm.web.protocol.report import Report
from latentarm.web.records.drive_log import About, DriveLog, Logged
from latentarm.web.records.drive_record import Ending
from latentarm.web.records.records import Records
from latentarm.web.server.connected_pages import ConnectedPages
from latentarm.web.server.states import States

SO_FAR_S: Final = 5.0  # how often the drive under way is written, s of the control process's clock
PURGE_S: Final = 60.0  # how often deleted records are removed for good, s


@final
class History:
    """Logs what is driven; another thread writes it."""

    def __init__(self, states: States, connected: ConnectedPages, records: Records) -> None:
        self._states = states
        self._connected = connected
        self._records = records
        self.log = DriveLog()  # of the drive under way
        self._keeping: set[asyncio.Task[None]] = set()
        self._in_order = asyncio.Lock()  # a drive that has ended is written after what was known before
        self._written_s = 0.0
        self.problem: Notice | None = None  # why the last drive was not kept; None if it was
        states.heard.append(self._hear)

    async def follow(self) -> None:
        """Purge deleted records, until cancelled."""
        while True:
            await asyncio.sleep(PURGE_S)
            try:
                await asyncio.to_thread(self._records.purge)
            except UserError as error:
                self.problem = notice_of(error)

    @property
    def person(self) -> str | None:
        """Id of the person whose drive is under way."""
        about = self.log.under_way
        return None if about is None else about.person

    def end(self, why: Ending) -> None:
        if (logged := self.log.end(why)) is not None:
            self._do(partial(self._write, logged))

    def keep_profile(self, person: str, run: str, name: str) -> None:
        """Note that a new profile is a person's."""
        self._do(partial(self._records.people.add_profile, person, run, name))

    async def settled(self) -> None:
        """Wait until every drive that has ended is on disk."""
        await asyncio.gather(*self._keeping)

    async def close(self) -> None:
        """End the drive under way and wait for the disk."""
        self.end("server_ended")
        await self.settled()

    def _hear(self, report: Report) -> None:
        loaded = self._states.loaded
        if loaded.spec.shadow:
            return  # nobody has driven an arm
        about = self.log.under_way
        if about is not None and about.scene is not loaded.scene:
            self.end("run_changed")
        if not self.log.begins(report):
            if self.log.take(report) or report.time_s - self._written_s > SO_FAR_S:
                self._keep_so_far(report)
            return
        driver = self._connected.driver
        person = None if driver is None or self._gone(driver.person) else driver.person
        self.log.begin(report, About(person, loaded.setup, loaded.name, loaded.scene))
        self._keep_so_far(report)

    def _keep_so_far(self, report: Report) -> None:
        self._written_s = report.time_s
        drive = self.log.so_far()
        if drive is not None and not (drive.person and self._gone(drive.person)):
            self._do(partial(self._records.drives.keep_so_far, drive))

    def _gone(self, person: str | None) -> bool:
        return self._records.people.find(person) is None

    def _do(self, work: Callable[[], object]) -> None:
        task = asyncio.create_task(self._keep(work))
        self._keeping.add(task)
        task.add_done_callback(self._keeping.discard)

    async def _keep(self, work: Callable[[], object]) -> None:
        try:
            async with self._in_order:
                await asyncio.to_thread(work)
            self.problem = None
        except UserError as error:
            self.problem = notice_of(error)

    def _write(self, logged: Logged) -> None:
        if logged.record.person is None or not self._gone(logged.record.person):
            self._records.keep(logged)
