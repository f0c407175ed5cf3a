"""`latentarm teleop`: the page, its server, and the control process behind it."""

import asyncio
import logging
import shlex
import signal
import socket
from collections.abc import AsyncGenerator, Callable, Generator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import replace
from functools import partial
from types import FrameType
from typing import Final, cast, final

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp

from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.checking import look_at
from latentarm.control.clock import MonotonicClock
from latentarm.core.child_processes import HANG_UPS
from latentarm.core.errors import UserError
from latentarm.core.logs import logging_also_to
from latentarm.core.punctuality import short_collections
from latentarm.demonstrations.folders import locked
from latentarm.recordings.folder import JOURNAL_SUFFIX
from latentarm.robots.notices import notices
from latentarm.surroundings.catalogue import TOUCH
from latentarm.surroundings.process import SourceProcess
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup, load_setup
from latentarm.web.arm_process.incident import computer
from latentarm.web.arm_process.process import ControlProcess
from latentarm.web.cameras.process import CameraProcess
from latentarm.web.jobs.training import model_names
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import ChooseProfile
from latentarm.web.protocol.page_messages import FRAME_LIMIT
from latentarm.web.records.people import PersonRecord
from latentarm.web.records.person_zip import IMPORT_LIMIT
from latentarm.web.records.records import FOLDER, Records
from latentarm.web.server import connections
from latentarm.web.server.answers import refused
from latentarm.web.server.assets import Assets
from latentarm.web.server.camera_routes import CameraRoutes
from latentarm.web.server.config import TeleopConfig, check_certificate, listen
from latentarm.web.server.connected_pages import ConnectedPages
from latentarm.web.server.drive_socket import DriveSocket
from latentarm.web.server.health import Health
from latentarm.web.server.history import History
from latentarm.web.server.invitations import Invitations
from latentarm.web.server.keys import Keys
from latentarm.web.server.learning import Learning
from latentarm.web.server.loaded_run import LoadedRun, RunList
from latentarm.web.server.pages import Pages
from latentarm.web.server.people_routes import IMPORT, PeopleRoutes
from latentarm.web.server.pins import Pins
from latentarm.web.server.pose_book import PoseBook
from latentarm.web.server.rate_limit import MeteredSocket
from latentarm.web.server.record_routes import RecordRoutes
from latentarm.web.server.security import DRIVE, Gate
from latentarm.web.server.setup_lock import SetupLock
from latentarm.web.server.states import States

_LOG: Final = logging.getLogger(__name__)

_LOOK_S: Final = 1.0
LOG: Final = "teleop.log"  # in the output folder
_LOCK: Final = ".teleop.lock"  # locked in the output folder while a server runs
_COOKIES: Final = ".teleop-cookies.json"  # in the output folder: who may come back after a restart
_STARTED_S: Final = 0.01


def serve(
    config: TeleopConfig,
    say: Callable[[str], None],
    ready: Callable[[str], None] = lambda address: None,
    *,
    draws: bool = False,
) -> None:
    """Serve the page until Ctrl-C, then say how to use what was recorded.

    ``say`` prints a line for the person who started the server. ``ready`` is called once with the address to
    open first: the page's, or a one-time link. ``draws``: whether the terminal can show a QR code. Raises
    UserError if the run or profile cannot be loaded, another server records to the folder, the address is
    taken, a file for TLS is broken, or a camera gives no picture.
    """
    check_certificate(config)
    setup = load_setup(config.spec)
    out = config.spec.out
    out.mkdir(parents=True, exist_ok=True)
    with ExitStack() as at_end:
        at_end.enter_context(
            locked(out, out / _LOCK, "end it with Ctrl-C, or choose another folder with --out")
        )
        at_end.enter_context(logging_also_to(out / LOG))
        _LOG.info("The server begins: %s.", computer())
        if setup.real:
            config, setup = _looked_at(config, setup, say)
        before = set(out.glob(f"*{JOURNAL_SUFFIX}"))
        at_end.callback(_LOG.info, "The server ends.")
        listening = at_end.enter_context(listen(config))
        cameras = CameraProcess(config.cameras, listening.getsockname()[0]) if config.cameras else None
        if cameras is not None:
            at_end.callback(cameras.end)
        port = int(listening.getsockname()[1])
        base = config.origins(port)[0]
        keys = None if config.private else Keys(store=config.spec.out / _COOKIES)
        invitations = None if keys is None else Invitations(keys.new_link, base, say, draws)

        for sentence in notices(setup.task.robot):
            say(sentence)
        if setup.real:
            speeds = config.spec.speeds
            say(
                f"No joint turns faster than {speeds.joint:g} rad/s, and no part of the arm moves faster than"
                f" {100 * speeds.link:g} cm/s."
            )
        if config.spec.zones:
            slow = ", ".join(f"{zone.name} ({100 * zone.speed:g} cm/s)" for zone in config.spec.zones)
            say(f"The arm is slow in these zones: {slow}.")
        if config.spec.keep_out:
            say(f"The arm keeps out of: {', '.join(one.name for one in config.spec.keep_out)}.")
        sources = _sources(setup, say)
        if sources is not None:
            at_end.callback(sources.end)
        control = ControlProcess(config.spec, None if sources is None else sources.sightings)
        at_end.callback(control.end)
        app = build_app(setup, control, config, cameras)
        gate = gated(
            app, control, config, port, keys, (lambda: "") if invitations is None else invitations.next
        )

        def open_it() -> None:
            first = f"{base}/" if invitations is None else invitations.new_link()
            say(f"The page is at {first} (end with Ctrl-C).")
            if invitations is not None:
                invitations.draw(first)
                say("This link works once; when it is used the next one is printed.")
                if not config.encrypted:
                    say(
                        "Without --certfile and --keyfile, or an https --public-url, the network can read and"
                        " change what is sent."
                    )
            ready(first)
            if config.spec.run is None:
                say(
                    "Without a run the page has end-effector control alone; `latentarm demo` or `latentarm"
                    " train` makes one, and `latentarm teleop RUN` drives it."
                )

        serve_gate(gate, config, listening, open_it)
        say("The page is closed.")
    for journal in sorted(set(out.glob(f"*{JOURNAL_SUFFIX}")) - before):
        say(f"To use what was recorded: latentarm export {shlex.quote(str(journal))} --out NEW_FOLDER")


def serve_gate(gate: Gate, config: TeleopConfig, listening: socket.socket, ready: Callable[[], None]) -> None:
    """Serve until Ctrl-C, SIGTERM or a closed terminal; ``ready`` is called once before."""
    server = _Server(server_config(gate, config))
    with _ended_by_signals(server):
        ready()
        # Every input passes through here.
        with short_collections():
            asyncio.run(serve_on(listening, server, connections.limits_here()))


@final
class _Server(uvicorn.Server):
    """Ends cleanly: at a second Ctrl-C uvicorn would break off with a traceback."""

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self.should_exit = True


@contextmanager
def _ended_by_signals(server: _Server) -> Generator[None]:
    """Let Ctrl-C, SIGTERM and a closed terminal end the server, whatever a library that is starting does.

    Under `nohup` a closed terminal ends nothing.
    """
    hang_ups = [one for one in HANG_UPS if signal.getsignal(one) is not signal.SIG_IGN]
    signals = (signal.SIGINT, signal.SIGTERM, *hang_ups)
    before = {number: signal.signal(number, server.handle_exit) for number in signals}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _looked_at(
    config: TeleopConfig, setup: DriveSetup, say: Callable[[str], None]
) -> tuple[TeleopConfig, DriveSetup]:
    """Query a real arm once; the control process connects to it later."""
    robot = setup.task.robot
    found = look_at(make_real_arm(setup.arm, robot, MonotonicClock().now_s), robot, PERIOD_S)
    for refusal in found.refusals:
        raise UserError(refusal)
    say(f"A real arm is at {setup.arm}. It says of itself:")
    for fact in found.facts:
        say(f"  {fact.name}: {fact.value}")
    for notice in found.notices:
        say(notice)
    if setup.spec.shadow:
        say("Shadow mode: nothing is sent to the arm.")
    if not setup.obstacles:
        say("Nothing keeps the arm off a table: state it with --zones FILE (`latentarm guide zones.toml`).")
    kept_off = ", ".join(one.name for one in setup.obstacles) or "nothing, as nothing is stated"
    facts = [(fact.name, fact.value) for fact in found.facts]
    spec = replace(setup.spec, found=(*facts, ("keeps out of", kept_off)))
    return replace(config, spec=spec), replace(setup, spec=spec)


def _sources(setup: DriveSetup, say: Callable[[str], None]) -> SourceProcess | None:
    names = [thing.name for thing in setup.tracked]
    if not names:
        return None
    texts = [text for text in setup.spec.objects if text != TOUCH]
    shown = ", ".join(names)
    if not texts:
        say(
            f"Nobody sees where things are ({shown}): bring the tool to each, and say so on the page (Poses)."
        )
        return None
    say(f"Positions of {shown} come from {', '.join(texts)}, and from the tool on the page (Poses).")
    return SourceProcess(texts, names)


async def tell_end(control: ControlProcess, history: History) -> None:
    """Log that the control process has ended before the server, and end its drive."""
    while control.alive:
        await asyncio.sleep(_LOOK_S)
    history.end("broken_off")
    _LOG.error("The program that moves the arm has ended. Start latentarm teleop again.")


def build_app(
    setup: DriveSetup, control: ControlProcess, config: TeleopConfig, cameras: CameraProcess | None = None
) -> Starlette:
    """The application: pages, their assets, the scene, and the socket that drives."""
    connected = ConnectedPages()
    spec = setup.spec
    run_list = RunList(spec.out, spec.run)
    states = States(LoadedRun(setup, run_list.name_of(spec.run)), control, connected, run_list)
    records = Records(spec.out, run_list.runs, states.journal)
    learning = Learning(control, states, run_list, records.recordings, spec.out)
    history = History(states, connected, records)
    health = Health(states, connected, history, cameras)
    pins = Pins(records.people, wanted=config.pins)
    lock = SetupLock(records.people, states, on=config.lock_setup)
    poses = PoseBook(records.people, spec.out / FOLDER)
    drive = DriveSocket(control, states, connected, learning, records.people, pins, history, poses, lock)

    def driven_with(person: PersonRecord) -> bool:
        report = states.report
        return report is not None and report.profile in {profile.name for profile in person.profiles}

    def busy(person: PersonRecord) -> bool:
        driver = connected.driver
        theirs = driven_with(person) or (driver is not None and driver.person == person.id)
        return theirs and not states.at_rest

    def let_go(person: PersonRecord) -> None:
        if driven_with(person):
            control.order(ChooseProfile(name=None))

    assets = Assets()
    camera_names = [] if cameras is None else [source.name for source in cameras.sources]
    pages = Pages(assets, model_names(), camera_names, locked=lock.on, fixed=spec.fixed is not None)
    camera_routes = None if cameras is None else CameraRoutes(cameras, connected)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncGenerator[None]:
        follow = [states.follow, learning.follow, history.follow, partial(tell_end, control, history)]
        if camera_routes is not None:
            follow.append(camera_routes.follow)
        following = [asyncio.create_task(one()) for one in follow]
        try:
            yield
        finally:
            for task in following:
                task.cancel()
            await poses.settled()
            await history.close()
            await learning.close()

    async def describe(_: Request) -> Response:
        return JSONResponse(states.loaded.scene.description)

    async def mesh(request: Request) -> Response:
        # Compared as text: a number in a path may have any length.
        named = {str(number): content for number, content in states.loaded.scene.meshes.items()}
        content = named.get(request.path_params["number"])
        if content is None:
            raise HTTPException(404, "There is no such mesh.")
        return Response(content, media_type="application/octet-stream")

    routes = [
        WebSocketRoute(DRIVE, drive.answer),
        Route("/scene.json", describe),
        Route("/mesh/{number}", mesh),
        *health.routes(),
        *PeopleRoutes(records, history, busy, let_go, pins, lock).routes(),
        *RecordRoutes(records, history, pins).routes(),
        *([] if camera_routes is None else camera_routes.routes()),
        *(Route(page.path, pages.answer) for page in pages.all),
        Route("/static/{version}/{name:path}", assets.answer),
    ]
    handlers = {HTTPException: _in_json, UserError: refused}
    return Starlette(routes=routes, lifespan=lifespan, exception_handlers=handlers)


async def _in_json(_: Request, error: Exception) -> Response:
    refused = cast(HTTPException, error)
    return JSONResponse({"detail": refused.detail}, refused.status_code, refused.headers)


def gated(
    app: ASGIApp,
    control: ControlProcess,
    config: TeleopConfig,
    port: int,
    keys: Keys | None,
    invite: Callable[[], str],
) -> Gate:
    """The application behind its gate. ``keys`` is None on the loopback."""
    origins = frozenset(config.origins(port))
    hosts = frozenset(origin.split("//")[1] for origin in origins)
    return Gate(
        app,
        hosts,
        origins,
        keys,
        secure=config.encrypted,
        stop=lambda _: control.stop(Notice(code="stop_pressed")),
        invite=invite,
        long_bodies={IMPORT: IMPORT_LIMIT},
    )


def server_config(app: ASGIApp, config: TeleopConfig) -> uvicorn.Config:
    """Configuration of uvicorn: everything bounded, nothing compressed, no proxy trusted."""
    return uvicorn.Config(
        app,
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,
        http="h11",
        h11_max_incomplete_event_size=connections.HEAD_LIMIT,
        ws=MeteredSocket,
        ws_max_size=FRAME_LIMIT,
        ws_ping_interval=5.0,
        ws_ping_timeout=10.0,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=1,
        ssl_certfile=config.certfile,
        ssl_keyfile=config.keyfile,
    )


async def serve_on(
    listening: socket.socket, server: uvicorn.Server, limits: connections.ConnectionLimits
) -> None:
    """Serve until the server is asked to exit. Raises OSError if no connections can be accepted any more."""

    async def accept() -> None:
        while not server.started:
            await asyncio.sleep(_STARTED_S)

        def protocol() -> connections.SlicedProtocol:
            return connections.SlicedProtocol(server.config, server.server_state, server.lifespan.state)

        await connections.Connections(listening, protocol, server.config.ssl, limits).accept()

    def exit_too(_: asyncio.Task[None]) -> None:
        server.should_exit = True

    accepting = asyncio.create_task(accept())
    accepting.add_done_callback(exit_too)
    try:
        await server.serve(sockets=[])
    finally:
        accepting.cancel()
    if accepting.done() and not accepting.cancelled():
        accepting.result()
