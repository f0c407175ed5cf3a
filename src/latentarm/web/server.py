"""`latentarm teleop`: the page, its server, and the control process behind it."""

import asyncio
from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Final

import uvicorn
from fastapi import FastAPI
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from latentarm.web.addresses import TeleopConfig, check_certificate, listen, origin
from latentarm.web.drive import DriveSocket
from latentarm.web.security import ENTRY, STOP, Gate, Keys
from latentarm.web.sessions import Sessions
from latentarm.web.setting import Setting, load_setting
from latentarm.web.shelf import Shelf
from latentarm.web.stage import Stage
from latentarm.web.states import States
from latentarm.web.supervisor import ControlProcess
from latentarm.web.workshop import Bench

_STATIC: Final = Path(__file__).parent / "static"
_FRAMEWORK_FRAME_LIMIT: Final = 1 << 16
"""NiceGUI's own socket carries forms; the one that drives is held to `messages.FRAME_LIMIT`."""

_MOST_CONNECTIONS: Final = 256


def serve(
    config: TeleopConfig, say: Callable[[str], None], ready: Callable[[str], None] = lambda address: None
) -> None:
    """Serve the page until Ctrl-C.

    Args:
        config: what was asked for.
        say: tells the person who started it.
        ready: called once with the address to open first: the page's, or a link that works once.

    Raises:
        UserError: the run or profile is not to be had, the address is taken, or a file for TLS is broken.
    """
    check_certificate(config)
    setting = load_setting(config.spec)
    listening = listen(config)
    port = int(listening.getsockname()[1])
    base = origin(config.scheme, config.host, port)
    keys = None if config.loopback else Keys()

    def link() -> str:
        return f"{base}/" if keys is None else f"{base}{ENTRY}?key={keys.new_link()}"

    def invite() -> None:
        say(f"For the next person, a link that works once: {link()}")

    control = ControlProcess(config.spec)
    try:
        app = build_app(setting, control)
        _add_pages(app)
        gate = gated(app, config, port, keys, invite)
        first = link()
        say(f"The page is at {first} (end with Ctrl-C).")
        if keys is not None:
            say("This link works once; when it is used the next one is printed.")
            if config.scheme == "http":
                say("Without --certfile and --keyfile the network can read and change what is sent.")
        ready(first)
        if config.spec.run is None:
            say(
                "Without a run the page has end-effector control alone; `latentarm demo` or `latentarm train`"
                " makes one, and `latentarm teleop RUN` drives it."
            )
        uvicorn.Server(server_config(gate, config)).run(sockets=[listening])
    except KeyboardInterrupt:
        say("The page is closed.")
    finally:
        control.end()
        listening.close()


def build_app(setting: Setting, control: ControlProcess) -> FastAPI:
    """The application without its pages: socket, scene, static files, and a Stop that needs no socket.

    Args:
        setting: what is driven.
        control: drives it.
    """
    sessions = Sessions()
    spec = setting.spec
    shelf = Shelf(spec.out, spec.run)
    states = States(Stage(setting, shelf.name_of(spec.run)), control, sessions, shelf)
    bench = Bench(control, states, shelf, spec.out)
    drive = DriveSocket(control, states, sessions, bench)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncGenerator[None]:
        following = [asyncio.create_task(one.follow()) for one in (states, bench)]
        try:
            yield
        finally:
            for task in following:
                task.cancel()
            await bench.close()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)

    async def describe(_: Request) -> Response:
        return JSONResponse(states.stage.scene.description)

    async def mesh(request: Request) -> Response:
        content = states.stage.scene.meshes.get(int(request.path_params["number"]))
        if content is None:
            return JSONResponse({"detail": "There is no such mesh."}, 404)
        return Response(content, media_type="application/octet-stream")

    async def stop(_: Request) -> Response:
        drive.stop("Somebody")
        return Response(status_code=204)

    app.add_api_websocket_route("/drive", drive)
    app.add_route("/scene.json", describe)
    app.add_route("/mesh/{number:int}", mesh)
    app.add_route(STOP, stop, methods=["POST"])
    app.mount("/static", StaticFiles(directory=_STATIC))
    return app


def gated(
    app: ASGIApp, config: TeleopConfig, port: int, keys: Keys | None, entered: Callable[[], None]
) -> Gate:
    """The application behind its gate.

    Args:
        app: from `build_app`.
        config: says by which names the page is reached.
        port: that it listens on.
        keys: None on the loopback.
        entered: see `Gate`.
    """
    names = ["127.0.0.1", "localhost", config.host] if config.loopback else [config.host]
    origins = frozenset(origin(config.scheme, name, port) for name in names)
    hosts = frozenset(origin.split("//")[1] for origin in origins)
    return Gate(app, hosts, origins, keys, secure=config.scheme == "https", entered=entered)


def server_config(app: ASGIApp, config: TeleopConfig) -> uvicorn.Config:
    """How the application is served: everything bounded, nothing compressed, no proxy believed."""
    return uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws_max_size=_FRAMEWORK_FRAME_LIMIT,
        ws_ping_interval=5.0,
        ws_ping_timeout=10.0,
        ws_per_message_deflate=False,
        limit_concurrency=_MOST_CONNECTIONS,
        timeout_graceful_shutdown=1,
        ssl_certfile=config.certfile,
        ssl_keyfile=config.keyfile,
    )


def _add_pages(app: FastAPI) -> None:
    # NiceGUI takes a second to load, and only a server that shows pages needs it.
    from nicegui import ui

    from latentarm.web.page import add_pages

    add_pages()
    ui.run_with(app, title="latentarm", tailwind=False, show_welcome_message=False)
