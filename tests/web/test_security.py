"""The gate: exact names, a cookie that a link was exchanged for, and headers on everything."""

import asyncio
import json
from dataclasses import dataclass

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route, WebSocketRoute

from latentarm.web.server.keys import LIFE_S, Keys
from latentarm.web.server.security import COOKIE, EXPIRED, EXPIRED_WHY, MOST_REQUESTS, Gate

HOST = "arm.example:8460"
ORIGIN = "https://arm.example:8460"


async def hello(request):
    return PlainTextResponse("hello")


async def greet(socket):
    await socket.accept()
    await socket.close()


APP = Starlette(
    routes=[
        Route("/", hello, methods=["GET", "POST"]),
        Route("/health", hello),
        Route("/metrics", hello),
        WebSocketRoute("/drive", greet),
        WebSocketRoute("/other", greet),
    ]
)


@dataclass
class Answer:
    status: int
    headers: dict[str, str]
    text: str


class Visitor:
    """Speaks ASGI to a gate, and keeps its cookie."""

    def __init__(self, keys=None):
        self.stops = 0
        invite = (lambda: "") if keys is None else (lambda: f"{ORIGIN}/enter?key={keys.new_link()}")
        self.gate = Gate(
            APP, frozenset({HOST}), frozenset({ORIGIN}), keys, secure=True, stop=self.stop, invite=invite
        )
        self.cookie = None

    def stop(self, headers):
        self.stops += 1

    def scope(self, kind, path, headers, **more):
        named = {"host": HOST, **({"cookie": self.cookie} if self.cookie else {}), **headers}
        raw = [(name.encode(), value.encode()) for name, value in named.items() if value is not None]
        return {"type": kind, "path": path, "headers": raw, "query_string": b"", **more}

    async def told(self, path="/", method="GET", query="", *, body_follows=False, **headers):
        """What is sent in answer; where a body was to follow, the visitor hangs up instead."""
        sent = []
        parts = [
            {"type": "http.request", "body": b"", "more_body": body_follows},
            {"type": "http.disconnect"},
        ]

        async def receive():
            return parts.pop(0)

        async def send(message):
            sent.append(message)

        scope = self.scope("http", path, headers, method=method)
        scope["query_string"] = query.encode()
        await self.gate(scope, receive, send)
        return sent

    def ask(self, path="/", method="GET", query="", **headers):
        sent = asyncio.run(self.told(path, method, query, **headers))
        headers = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
        if "set-cookie" in headers:
            self.cookie = headers["set-cookie"].split(";")[0]
        return Answer(sent[0]["status"], headers, b"".join(part["body"] for part in sent[1:]).decode())

    def drives(self, path="/drive", **headers):
        """Whether a socket is accepted."""
        sent = []

        async def receive():
            return {"type": "websocket.connect"}

        async def send(message):
            sent.append(message["type"])

        asyncio.run(self.gate(self.scope("websocket", path, headers), receive, send))
        return sent[0] == "websocket.accept"


class Watch:
    now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.fixture
def watch():
    return Watch()


@pytest.fixture
def keys(watch):
    return Keys(watch)


def test_a_link_is_exchanged_for_a_cookie_once(keys):
    visitor = Visitor(keys)
    assert visitor.ask().status == 401
    key = keys.new_link()
    assert len(key) * 6 >= 128
    entered = visitor.ask("/enter", query=f"key={key}")
    assert entered.status == 200
    assert key not in entered.text
    cookie = entered.headers["set-cookie"].lower()
    assert all(word in cookie for word in ("httponly", "secure", "samesite=strict", f"max-age={LIFE_S}"))
    assert visitor.ask().text == "hello"
    assert visitor.drives(origin=ORIGIN)
    other = Visitor(keys)
    assert other.ask("/enter", query=f"key={key}").status == 403
    assert other.ask().status == 401


def test_the_host_alone_may_invite_and_the_link_works_once(keys):
    host, guest, stranger = Visitor(keys), Visitor(keys), Visitor(keys)
    host.ask("/enter", query=f"key={keys.new_link()}")
    assert json.loads(host.ask("/invitation").text) == {"may": True}
    invited = json.loads(host.ask("/invitation", "POST", origin=ORIGIN).text)
    assert host.ask("/invitation", "POST").status == 403  # no origin
    assert len(invited["path"]) > 100
    key = invited["link"].split("key=")[1]
    assert guest.ask("/enter", query=f"key={key}").status == 200
    assert Visitor(keys).ask("/enter", query=f"key={key}").status == 403
    assert guest.ask().status == 200
    assert json.loads(guest.ask("/invitation").text) == {"may": False}
    assert guest.ask("/invitation", "POST", origin=ORIGIN).status == 403
    assert host.ask("/invitation", "DELETE", origin=ORIGIN).status == 405
    assert stranger.ask("/invitation").status == 401
    assert stranger.ask("/invitation", "POST", origin=ORIGIN).status == 401


def test_on_the_loopback_nobody_is_invited():
    visitor = Visitor()
    assert json.loads(visitor.ask("/invitation").text) == {"may": False}
    assert visitor.ask("/invitation", "POST", origin=ORIGIN).status == 403


def test_a_new_link_voids_the_one_before(keys):
    old = keys.new_link()
    keys.new_link()
    assert Visitor(keys).ask("/enter", query=f"key={old}").status == 403


@pytest.mark.parametrize("query", ["", "key=", "key=x", "key=%00", "k=1&k=2", "key=" + "x" * 2000])
def test_other_keys_open_nothing(keys, query):
    keys.new_link()
    assert Visitor(keys).ask("/enter", query=query).status == 403


def test_a_cookie_is_good_for_eight_hours(keys, watch):
    visitor = Visitor(keys)
    visitor.ask("/enter", query=f"key={keys.new_link()}")
    watch.now_s = LIFE_S - 1.0
    assert visitor.ask().status == 200
    watch.now_s = LIFE_S + 1.0
    assert visitor.ask().status == 401


@pytest.mark.parametrize("cookie", ["", "x", "x" * 4000, "=;;=", '"', "\\", "é"])
def test_other_cookies_open_nothing(keys, cookie):
    visitor = Visitor(keys)
    visitor.ask("/enter", query=f"key={keys.new_link()}")
    visitor.cookie = f"{COOKIE}={cookie}"
    assert visitor.ask().status == 401
    assert not visitor.drives(origin=ORIGIN)


@pytest.mark.parametrize(
    "host",
    ["evil.example", "arm.example", "arm.example:8461", f"{HOST}.evil.example", "", "127.0.0.1:8460", None],
)
def test_another_host_is_not_answered(host):
    visitor = Visitor()
    assert visitor.ask(host=host).status == 421
    assert not visitor.drives(host=host, origin=ORIGIN)


@pytest.mark.parametrize(
    "origin",
    ["https://evil.example", f"http://{HOST}", "https://arm.example", "null", f"{ORIGIN}.evil.example", ""],
)
def test_another_origin_is_not_served(origin):
    visitor = Visitor()
    assert visitor.ask(origin=origin).status == 403
    assert visitor.ask("/stop", "POST", origin=origin).status == 403
    assert not visitor.drives(origin=origin)


def test_sockets_and_posts_must_name_their_origin():
    visitor = Visitor()
    assert visitor.ask().status == 200
    assert visitor.ask(method="POST").status == 403
    assert visitor.ask(method="POST", origin=ORIGIN).status == 200
    assert not visitor.drives()
    assert visitor.drives(origin=ORIGIN)


def test_stop_needs_no_cookie_but_the_right_origin(keys):
    visitor = Visitor(keys)
    assert visitor.ask("/stop", "POST", origin=ORIGIN).status == 204
    assert visitor.stops == 1
    assert visitor.ask("/stop", "POST").status == 403
    assert visitor.stops == 1


@pytest.mark.parametrize(
    "said", [{"content-length": str(1 << 21)}, {"content-length": "-1"}, {"transfer-encoding": "chunked"}]
)
def test_long_bodies_are_not_read(said):
    assert Visitor().ask(method="POST", origin=ORIGIN, **said).status == 413


def test_every_answer_says_what_a_page_may_do(keys):
    for answer in (
        Visitor().ask(),
        Visitor(keys).ask(),
        Visitor().ask(host="evil"),
        Visitor().ask("/nowhere"),
    ):
        assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "no-referrer"


def test_health_needs_no_link_but_the_right_name_and_metrics_need_both(keys):
    assert Visitor(keys).ask("/health").status == 200
    assert Visitor(keys).ask("/health", host="evil").status == 421
    assert Visitor(keys).ask("/metrics").status == 401
    assert Visitor().ask("/metrics").status == 200


def test_stop_is_a_post_and_builds_no_page(keys):
    visitor = Visitor(keys)
    for method in ("GET", "HEAD", "PUT", "OPTIONS"):
        answer = visitor.ask("/stop", method, origin=ORIGIN)
        assert answer.status == 405
        assert answer.headers["allow"] == "POST"
    assert visitor.stops == 0


def test_stop_is_outside_the_cap_on_requests():
    async def run():
        visitor = Visitor()
        held = asyncio.Event()

        async def wait(scope, receive, send):
            await held.wait()

        visitor.gate.app = wait
        waiting = [asyncio.create_task(visitor.told("/")) for _ in range(MOST_REQUESTS)]
        await asyncio.sleep(0)
        assert (await visitor.told("/"))[0]["status"] == 503
        assert (await visitor.told("/stop", "POST", origin=ORIGIN, body_follows=True))[0]["status"] == 204
        held.set()
        await asyncio.gather(*waiting)

    asyncio.run(run())


def test_a_refused_request_ends_its_connection():
    assert Visitor().ask(host="evil").headers["connection"] == "close"
    assert "connection" not in Visitor().ask().headers


def test_a_body_that_never_comes_reaches_nobody():
    async def run():
        visitor = Visitor()
        reached = []

        async def app(scope, receive, send):
            reached.append(await receive())

        visitor.gate.app = app
        assert await visitor.told("/", "POST", origin=ORIGIN, body_follows=True) == []
        assert not reached

    asyncio.run(run())


def test_an_open_socket_ends_with_its_cookie(keys, watch):
    visitor = Visitor(keys)
    visitor.ask("/enter", query=f"key={keys.new_link()}")
    watch.now_s = LIFE_S - 0.01
    heard = []

    async def app(scope, receive, send):
        heard.append(await receive())

    visitor.gate.app = app

    async def receive():
        await asyncio.Event().wait()

    async def send(message):
        raise AssertionError(message)

    asyncio.run(visitor.gate(visitor.scope("websocket", "/drive", {"origin": ORIGIN}), receive, send))
    assert heard == [{"type": "websocket.disconnect", "code": EXPIRED, "reason": EXPIRED_WHY}]


def test_the_socket_that_drives_is_the_only_one():
    visitor = Visitor()
    assert visitor.drives(origin=ORIGIN)
    assert not visitor.drives("/other", origin=ORIGIN)


def test_pages_run_no_script_but_their_own_files():
    policy = Visitor().ask().headers["content-security-policy"]
    assert "script-src 'self';" in policy
    assert "unsafe" not in policy
