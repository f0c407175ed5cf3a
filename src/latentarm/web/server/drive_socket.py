"""The WebSocket that pages drive through."""

import asyncio
import secrets
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, final

from starlette.websockets import WebSocket, WebSocketDisconnect

from latentarm.web.protocol import orders, page_messages
from latentarm.web.protocol.learning_messages import PickRun, Train
from latentarm.web.protocol.notice import Notice, NoticeCode
from latentarm.web.protocol.page_messages import CopilotPace, PressCopilot
from latentarm.web.protocol.personalise_messages import AnswerQuestion, PersonaliseMessage
from latentarm.web.protocol.server_messages import Refused
from latentarm.web.records.drive_record import Ending
from latentarm.web.records.people import People
from latentarm.web.server.connected_pages import MOST, ConnectedPages, Page
from latentarm.web.server.history import History
from latentarm.web.server.learning import Learning
from latentarm.web.server.pins import Pins
from latentarm.web.server.pose_book import PoseBook
from latentarm.web.server.receiving import ExpiredError, ViolationError, receive
from latentarm.web.server.security import EXPIRED, EXPIRED_WHY
from latentarm.web.server.setup_lock import SetupLock
from latentarm.web.server.states import PageMemory, States

if TYPE_CHECKING:
    from latentarm.web.arm_process.process import ControlProcess

HELLO_WITHIN_S: Final = 5.0
HANG_UP_WITHIN_S: Final = 1.0

DRIVER_PERIOD_S: Final = 0.02
WATCHER_PERIOD_S: Final = 0.033
"""How often a page is sent a state, s; the start of a motion is sent at once. The driver's next input is
fresh through these states."""

_FULL: Final = 1013  # WebSocket close code: try again later
_BEING_REFUSED: Final = 8
"""So many further pages are accepted to be refused with a reason; more are not accepted."""


async def _hang_up(socket: WebSocket, code: int, why: Notice) -> None:
    """Send the reason and close, without waiting for a page that no longer reads."""
    with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
        async with asyncio.timeout(HANG_UP_WITHIN_S):
            await socket.send_text(Refused(notice=why).model_dump_json())
            await socket.close(code, why.code)


@final
@dataclass(eq=False)
class DriveSocket:
    """The endpoint of ``/drive``."""

    _control: "ControlProcess"
    _states: States
    _sessions: ConnectedPages
    _learning: Learning
    _people: People
    _pins: Pins
    _history: History
    _poses: PoseBook
    _lock: SetupLock

    def __post_init__(self) -> None:
        self._server = secrets.token_hex(8)
        self._open = 0
        self._asked: orders.AskedGripper | None = None
        # `States.arm_start` for which each page has confirmed the checklist
        self._confirmed: dict[str, int] = {}

    async def answer(self, socket: WebSocket) -> None:
        """Serve one page until it goes."""
        if self._open >= MOST + _BEING_REFUSED:
            await socket.close(_FULL)
            return
        self._open += 1
        try:
            await socket.accept()
            if self._open > MOST:
                await _hang_up(socket, _FULL, Notice(code="full", parameters={"most": MOST}))
            else:
                await self._serve(socket)
        finally:
            self._open -= 1

    def stop(self, page: Page, why: Literal["pressed", "page"]) -> None:
        """Stop the arm in the name of a page; see `PressStop`."""
        self._control.stop(_of(page, "stop_pressed_by" if why == "pressed" else "page_stopped"))

    async def _serve(self, socket: WebSocket) -> None:
        page: Page | None = None
        sender: asyncio.Task[None] | None = None
        try:
            async with asyncio.timeout(HELLO_WITHIN_S):
                hello = await receive(socket)
            if not isinstance(hello, page_messages.Hello) or (page := self._join(hello, socket)) is None:
                raise ViolationError
            sender = asyncio.create_task(self._send_states(socket, page))
            while True:
                self._take(page, await receive(socket))
        except ViolationError:
            self._control.stop(Notice(code="message_invalid"))
            await _hang_up(socket, 1008, Notice(code="page_refused"))
        except TimeoutError:
            # Nobody is driving from here yet, so a slow or silent connection does not stop the arm.
            await _hang_up(socket, 1008, Notice(code="no_hello"))
        except ExpiredError:
            if page is not None and self._sessions.drives(page):
                self._control.stop(Notice(code="driver_expired"))
            await _hang_up(socket, EXPIRED, Notice(code=EXPIRED_WHY))
        except WebSocketDisconnect:
            pass
        finally:
            if sender is not None:
                sender.cancel()
            if page is not None:
                self._leave(page)

    def _join(self, hello: page_messages.Hello, socket: WebSocket) -> Page | None:
        """The page of a person with a record, or of a guest; None if there are too many pages."""
        known = self._people.find(hello.person)
        if known is None:
            return self._sessions.join(hello.name)
        # A visitor who has not given the PIN drives as a guest.
        opened = self._pins.opened(known, socket.cookies)
        return self._sessions.join(known.name, known.id) if opened else self._sessions.join(None)

    def _leave(self, page: Page) -> None:
        self._confirmed.pop(page.id, None)
        if self._sessions.copilot.leaves(page.id):
            self._copilot_changed("copilot_gone", page)
        if self._sessions.leave(page):
            self._driver_changed(_of(page, "driver_gone"))

    async def _send_states(self, socket: WebSocket, page: Page) -> None:
        """Send states as fast as the page takes them, always the newest.

        What is driven and the state of learning come first, and again when they change.
        """
        shown = PageMemory()
        loaded = None
        tick = learning = poses = -1
        with suppress(RuntimeError, WebSocketDisconnect):
            while True:
                if loaded is not self._states.loaded:
                    loaded = self._states.loaded
                    shown = PageMemory()
                    poses = -1
                    await socket.send_text(loaded.welcome(page.id, self._server).model_dump_json())
                if learning != self._learning.number:
                    learning = self._learning.number
                    await socket.send_text(self._learning.text)
                if poses != self._poses.number:
                    poses = self._poses.number
                    told = self._poses.told(page.person, self._states.loaded.robot_name)
                    await socket.send_text(told.model_dump_json())
                tick = await self._states.after(tick)
                if loaded is not self._states.loaded:
                    continue
                await socket.send_text(self._states.text(page, shown))
                drives = self._sessions.drives(page)
                await self._states.pause(DRIVER_PERIOD_S if drives else WATCHER_PERIOD_S)

    def _take(self, page: Page, message: page_messages.ClientMessage) -> None:
        if isinstance(message, page_messages.Hello) or not self._suits(message):
            raise ViolationError
        match message:
            case page_messages.PressStop(why=why):
                self.stop(page, why)
            case page_messages.Press(type="ask_to_drive"):
                self._sessions.ask(page)
            case page_messages.Press(type="trail_clear"):
                self._states.trail += 1
            case page_messages.ConfirmChecklist(arm_start=arm_start):
                self._confirmed[page.id] = arm_start
            case CopilotPace() | PressCopilot() if not self._sessions.drives(page):
                self._take_from_copilot(page, message)
            case _ if self._sessions.drives(page) and not self._lock.refuses(page.person, message):
                self._take_from_driver(page, message)
            case _:
                pass

    def _take_from_copilot(self, page: Page, message: CopilotPace | PressCopilot) -> None:
        copilot = self._sessions.copilot
        match message:
            case CopilotPace(pace=pace, nonce=nonce):
                copilot.says(page.id, pace, nonce)
            case PressCopilot(type="ask_to_copilot"):
                if self._sessions.driver is not None:
                    copilot.ask(page.id)
            case PressCopilot():
                if copilot.leaves(page.id):
                    self._copilot_changed("copilot_ended", page)

    def _suits(self, message: page_messages.ClientMessage) -> bool:
        return (
            not isinstance(message, page_messages.DriverInput | AnswerQuestion)
            or len(message.u) <= self._states.loaded.input_dim
        )

    def _take_from_driver(self, page: Page, message: page_messages.ClientMessage) -> None:
        match message:
            case page_messages.DriverInput():
                self._give(message)
            case (
                page_messages.Press(type="enable") | page_messages.MotionWithoutStick(type="guide", on=True)
            ) if self._stands_still:
                pass
            case page_messages.Press(type="enable") if not self._confirmed_by(page):
                self._states.say(Notice(code="checklist_first"))
            case page_messages.Press(type="enable"):
                self._control.order(orders.Enable(driver=self._sessions.turn, stops=self._control.stops))
            case page_messages.HandOver(type="accept_copilot", to=to):
                copilot = self._sessions.named(to)
                if copilot is not None and self._sessions.copilot.accept(to):
                    self._copilot_changed("copilot_began", copilot)
            case PressCopilot(type="end_copilot"):
                copilot = self._sessions.named(self._sessions.copilot.page)
                if self._sessions.copilot.end() and copilot is not None:
                    self._copilot_changed("copilot_ended", copilot)
            case page_messages.RecordEpisode(on=on, task=task, by_hand=by_hand):
                self._control.order(
                    orders.Record(on=on, task=task, person=_recorded_as(page), by_hand=by_hand)
                )
            case page_messages.MotionWithoutStick(type="guide", on=on):
                self._control.order(orders.Guide(on=on, stops=self._control.stops))
            case page_messages.MotionWithoutStick(on=on):
                self._control.order(orders.Return(on=on))
            case page_messages.GoToPose(name=name, built_in=built_in):
                loaded = self._states.loaded
                if built_in is None:
                    pose = self._poses.find(page.person, loaded.robot_name, name)
                else:
                    pose = loaded.built_in(built_in, name)
                if pose is not None:
                    self._control.order(orders.Return(on=True, pose=pose))
            case page_messages.EditPoses(type="save_pose", name=name):
                self._save_pose(page, name)
            case page_messages.EditPoses(name=name):
                self._poses.delete(page.person, self._states.loaded.robot_name, name)
            case Train():
                self._learning.train(message)
            case page_messages.Press(type="cancel_training"):
                self._learning.cancel()
            case PickRun(run=run):
                self._learning.choose_run(run)
            case page_messages.HandOver(to=to):
                if self._sessions.hand_over(page, to):
                    self._driver_changed(_of(page, "handed_over"))
            case page_messages.Press(type="release"):
                if self._sessions.release(page):
                    self._driver_changed(_of(page, "driver_released"))
            case _ if isinstance(message, orders.DriverOrder):
                self._control.order(message)
                if isinstance(message, orders.Reset):
                    self._end_drive("reset")
                elif isinstance(message, orders.BeginTask):
                    self._end_drive("next" if message.anew else "again")
            case _ if isinstance(message, PersonaliseMessage):
                before = self._learning.personalising.look()
                self._learning.personalising.take(message)
                if message.type == "keep_alignment" and before is not None and before.phase == "learned":
                    self._note_profile(page)
            case _:
                pass

    @property
    def _stands_still(self) -> bool:
        """Whether the arm may neither be enabled nor guided: a run is loaded, or a person is asked."""
        return self._states.loading or self._learning.personalising.standstill is not None

    def _confirmed_by(self, page: Page) -> bool:
        """True if this page has confirmed the checklist since the connection to the arm was last lost."""
        return not self._states.loaded.setup.real or self._confirmed.get(page.id) == self._states.arm_start

    def _save_pose(self, page: Page, name: str) -> None:
        report = self._states.report
        if report is not None and report.phase not in ("moving", "stopping"):
            self._poses.save(page.person, self._states.loaded.robot_name, name, report.q)

    def _end_drive(self, ending: Ending) -> None:
        """End the drive if the arm is at rest, since only then it is reset."""
        if self._states.at_rest:
            self._history.end(ending)

    def _note_profile(self, page: Page) -> None:
        kept, run = self._learning.personalising.look(), self._states.loaded.name
        if kept is not None and kept.phase == "kept" and page.person is not None and run is not None:
            self._history.keep_profile(page.person, run, kept.name)

    def _driver_changed(self, why: Notice) -> None:
        """Stop the arm, and end the episode: it has one driver."""
        self._asked = None
        self._history.end("driver_changed")
        self._control.stop(why)
        self._control.order(orders.Record(on=False, task=""))

    def _copilot_changed(self, why: NoticeCode, copilot: Page) -> None:
        """Stop the arm: nobody's speed changes without their knowledge."""
        self._control.stop(Notice(code=why, parameters={"name": copilot.name}))

    def _give(self, message: page_messages.DriverInput) -> None:
        self._history.log.given(message.u, message.source, gripper=message.gripper is not None)
        padded = message.u + (0.0,) * (self._states.loaded.input_dim - len(message.u))
        if message.gripper is not None:
            self._asked = orders.AskedGripper(ask=message.gripper, seq=message.seq, nonce=message.nonce)
        told = {name: getattr(message, name) for name in orders.PersonInput.model_fields}
        turn, paced = self._sessions.turn, self._sessions.copilot.paced
        self._control.give(orders.Given(**told, driver=turn, u=padded, gripper=self._asked, paced=paced))


def _of(page: Page, code: NoticeCode) -> Notice:
    """A notice about a page; its id lets the page recognise itself."""
    return Notice(code=code, parameters={"name": page.name, "page": page.id})


def _recorded_as(page: Page) -> str:
    """The id of an episode's driver, else the name; "" for a guest without one."""
    return page.person or (page.name if isinstance(page.name, str) else "")
