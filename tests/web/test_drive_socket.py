"""A real server, a real control process, and pages without a browser."""

import asyncio
import json
import time
import urllib.error
import urllib.request
from itertools import pairwise

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from latentarm.robots.panda_look import SHELL_GROUP
from latentarm.web.protocol.page_messages import FRAME_LIMIT
from latentarm.web.server.rate_limit import BURST

from .conftest import way_m

HELLO = '{"type": "hello", "version": 1}'


def at_rest(page):
    page.wait(lambda state: state["phase"] in ("disengaged", "neutral_needed"))
    time.sleep(0.05)  # a state shows where the arm was before its last command
    first = page.state
    time.sleep(0.15)
    assert page.state["tick"] > first["tick"]
    assert way_m(first, page.state) == 0.0


def test_a_page_drives_the_arm_and_stops_it(site):
    with site.page() as page:
        assert page.welcome["modes"] == ["latent", "assisted", "end_effector"]
        assert page.welcome["latent_dim"] == 2
        assert [goal["name"] for goal in page.welcome["goals"]] == ["carrot", "tofu", "melon"]
        page.drive(1.0, 0.0)
        page.send(type="stop")
        at_rest(page)
        assert page.state["reason"]["code"] == "stop_pressed_by"
        assert page.state["reason"]["parameters"] == {"name": "Ada", "page": page.welcome["id"]}


def test_nothing_moves_without_enable(site):
    with site.page() as page:
        before = page.state
        page.u = [1.0, 1.0]
        time.sleep(0.5)
        assert way_m(before, page.state) == 0.0
        assert page.state["phase"] == "neutral_needed"


def test_a_page_that_goes_stops_the_arm(site):
    with site.page("Bob") as watcher, site.page() as page:
        watcher.send(type="release")
        page.send(type="ask_to_drive")
        page.wait(lambda state: state["you"])
        page.drive(1.0, 0.0)
        page.socket.close()
        at_rest(watcher)
        assert watcher.state["driver"] is None


def test_only_the_driver_drives_and_everybody_stops(site):
    with site.page() as ada, site.page("Bob") as bob:
        assert ada.wait(lambda state: state["watchers"] == 1)["you"]
        assert not bob.state["you"]
        assert bob.state["driver_name"] == "Ada"
        bob.u = [1.0, 1.0]
        for message in (
            {"type": "enable"},
            {"type": "mode", "mode": "end_effector", "axes": 2},
            {"type": "record", "on": True},
            {"type": "reset"},
            {"type": "return", "on": True},
            {"type": "hand_over", "to": bob.welcome["id"]},
            {"type": "release"},
        ):
            bob.send(**message)
        before = bob.state
        time.sleep(0.4)
        assert way_m(before, bob.state) == 0.0
        assert bob.state["mode"] == before["mode"]
        assert bob.state["recording"] is None
        assert ada.state["you"]
        ada.drive(1.0, 0.0)
        bob.send(type="stop")
        at_rest(ada)
        assert ada.state["reason"]["code"] == "stop_pressed_by"
        assert ada.state["reason"]["parameters"] == {"name": "Bob", "page": bob.welcome["id"]}


def test_driving_is_handed_over_and_the_arm_stops_for_it(site):
    with site.page() as ada, site.page("Bob") as bob:
        ada.drive(1.0, 0.0)
        bob.send(type="ask_to_drive")
        assert ada.wait(lambda state: state["asking"])["asking_name"] == "Bob"
        assert ada.state["phase"] == "moving"
        ada.send(type="hand_over", to=bob.welcome["id"])
        bob.wait(lambda state: state["you"])
        at_rest(bob)
        before = bob.state
        time.sleep(0.2)  # Ada still pushes
        assert way_m(before, bob.state) == 0.0
        bob.drive(1.0, 0.0)


def test_modes_can_be_switched_while_it_moves(site):
    with site.page() as page:
        page.drive(1.0, 0.0)
        pushed = page.u
        for mode, axes in (("end_effector", 1), ("assisted", None), ("latent", None)):
            page.send(type="mode", mode=mode, axes=axes)
            page.wait(lambda state, mode=mode: state["mode"] == mode and state["phase"] == "ready")
            assert page.state["let_go_first"]
            page.u = [0.0, 0.0]
            page.wait(lambda state: not state["let_go_first"])
            page.u = pushed
            page.wait(lambda state: state["phase"] == "moving")


def test_an_episode_ends_with_its_driver(site):
    with site.page() as ada, site.page("Bob") as bob:
        ada.send(type="record", on=True, task="stab")
        assert bob.wait(lambda state: state["recording"] and state["recording"]["on"])
        before = bob.state["recording"]["episodes"]
        ada.drive(1.0, 0.0)
        ada.socket.close()
        bob.wait(lambda state: not state["recording"]["on"] and state["recording"]["episodes"] > before)


def test_help_shows_in_the_state(site):
    with site.page() as page:
        page.send(type="mode", mode="assisted")
        page.drive(1.0, 0.0)
        state = page.wait(lambda state: state["alpha"] > 0.0)
        # Medium at first, which grows to 0.1 with how sure the robot is.
        assert state["help"] == "medium"
        assert state["alpha"] <= 0.1
        assert sum(state["belief"]) == pytest.approx(1.0, abs=1e-3)
        page.send(type="mode", mode="latent")
        page.wait(lambda state: state["alpha"] == 0.0)


def test_ghosts_are_sent_again_only_when_they_have_moved(site):
    with site.page() as page:
        page.wait(lambda state: state["ghosts"] and state["ghosts"]["ring"])
        paths = dict.fromkeys(("up", "down", "left", "right"), 6)
        assert {name: len(path) for name, path in page.state["ghosts"].items()} == {**paths, "ring": 32}
        with site.raw() as socket:
            socket.send(HELLO)
            heard = [json.loads(socket.recv()) for _ in range(15)]
            states = [message for message in heard if message["type"] == "state"]
            sent = [state["ghosts"] for state in states if state["ghosts"] is not None]
            assert states[0]["ghosts"] is sent[0]
            # An arm that still comes to rest from an earlier test leads elsewhere once more.
            assert len(sent) <= 2 < len(states)
            for before, after in pairwise(np.array(one["ring"]) for one in sent):
                assert np.abs(np.abs(after) - np.abs(before)).max() > 0.9e-3


def test_the_arm_goes_back_to_its_start_when_it_is_not_enabled(site, setup):
    start = {"tool": setup.task.robot.chain.forward(setup.start).position}
    with site.page() as page:
        page.drive(1.0, 0.0)
        page.send(type="reset")
        time.sleep(0.2)
        assert page.state["phase"] == "moving"
        page.send(type="stop")
        at_rest(page)
        assert way_m(start, page.state) > 0.01
        page.send(type="reset")
        page.wait(lambda state: way_m(start, state) < 2e-4)


def test_pages_beyond_the_cap_are_turned_away(site):
    held = []
    try:
        for _ in range(16):
            context = site.raw()
            held.append((context, context.__enter__()))
        # The next is told why, and that before it has said a word; many at once are not even accepted.
        with site.raw() as refused:
            assert json.loads(refused.recv(timeout=5.0))["notice"] == {
                "code": "full",
                "parameters": {"most": 16},
            }
            with pytest.raises(ConnectionClosed):
                refused.recv(timeout=5.0)
            assert refused.close_code == 1013
    finally:
        for context, _ in held:
            context.__exit__(None, None, None)


@pytest.mark.parametrize(
    "changes",
    [
        {"origin": "http://evil.example"},
        {"origin": None},
        {"origin": "null"},
        {"additional_headers": {"Host": "evil.example"}},
    ],
)
def test_sockets_from_elsewhere_are_not_accepted(site, changes):
    with pytest.raises((InvalidStatus, ValueError)), site.raw(**changes):
        pass


def ends(socket):
    """The code that the server closes with."""
    try:
        for _ in range(200):
            socket.recv(timeout=5)
        raise AssertionError("the connection was not ended")
    except ConnectionClosed as closed:
        return closed.rcvd.code


@pytest.mark.parametrize(
    "frame",
    [
        "",
        "{}",
        "[" * 3000,
        '{"type": "stop", "now": true}',
        '{"type": "input", "seq": 1, "nonce": "", "u": [NaN, 0], "source": "pointer", "latched": false}',
        '{"type": "input", "seq": 1, "nonce": "", "u": [0, 0, 0], "source": "pointer", "latched": false}',
        HELLO,
        b"\x00\x01",
        json.dumps({"type": "stop", "pad": "x" * FRAME_LIMIT}),
        "x" * (1 << 17),
    ],
    ids=["empty", "no type", "deep", "extra", "nan", "axes", "hello twice", "binary", "long", "huge"],
)
def test_what_is_no_message_ends_the_connection_and_stops_the_arm(site, frame):
    with site.page() as ada:
        ada.drive(1.0, 0.0)
        with site.raw() as socket:
            socket.send(HELLO)
            socket.recv()
            socket.send(frame)
            assert ends(socket) in (1008, 1009)
        at_rest(ada)


def test_the_first_message_must_be_hello(site):
    with site.raw() as socket:
        socket.send('{"type": "stop"}')
        assert ends(socket) == 1008


def flood(socket):
    """Send far more than the allowance, then wait for the end."""
    for _ in range(int(3 * BURST)):
        socket.send('{"type": "trail_clear"}')
    for _ in range(200):
        socket.recv(timeout=5)


def test_a_flood_ends_the_connection(site):
    with site.page() as ada:
        ada.drive(1.0, 0.0)
        with site.raw() as socket:
            socket.send(HELLO)
            with pytest.raises(ConnectionClosed) as closed:
                flood(socket)
        # A connection that is closed while frames are unread is reset, and its code may be lost.
        assert closed.value.rcvd is None or closed.value.rcvd.code == 1008
        at_rest(ada)


def test_what_a_driver_sends_that_is_no_message_stops_the_arm_too(site):
    frames = ('{"type": "stop", "now": true}', b"\x00\x01", json.dumps({"type": "input", "u": [1.0, 1.0]}))
    with site.page("Bob") as bob:
        bob.send(type="release")
        for frame in frames:
            with site.page("Ada") as ada:
                ada.send(type="ask_to_drive")
                ada.wait(lambda state: state["you"])
                ada.drive(1.0, 0.0)
                ada.socket.send(frame)
                ada.wait_closed()
                assert ada.closed in (1003, 1008)
                at_rest(bob)
                assert bob.state["driver"] is None
        bob.send(type="ask_to_drive")
        bob.wait(lambda state: state["you"])
        bob.drive(1.0, 0.0)


def test_a_watcher_that_sends_nonsense_stops_the_arm_and_takes_nothing_from_the_driver(site):
    """It may have been meant as Stop. Everything else is as after a watcher's Stop."""
    with site.page("Ada") as ada, site.page("Bob") as bob:
        ada.drive(1.0, 0.0)
        mode = ada.state["mode"]
        bob.socket.send('{"type": "stop", "now": true}')
        bob.wait_closed()
        at_rest(ada)
        assert ada.closed is None
        assert ada.state["you"]
        assert ada.state["mode"] == mode
        ada.drive(1.0, 0.0)


def storm(site, rounds, rng):
    """Eight connections at a time that send damaged messages, half of them after a sound hello."""
    sound = ['{"type": "enable"}', HELLO, '{"type": "input", "seq": 1, "nonce": "00", "u": [1, 1]}']

    async def one():
        from websockets.asyncio.client import connect

        text = bytearray(str(rng.choice(sound)).encode())
        for _ in range(rng.integers(1, 6)):
            at = int(rng.integers(len(text)))
            text[at : at + int(rng.integers(0, 3))] = rng.bytes(int(rng.integers(0, 3)))
        frame = bytes(text) if rng.random() < 0.3 else text.decode(errors="replace")
        async with connect(site.address, origin=site.origin, compression=None) as socket:
            if rng.random() < 0.5:
                await socket.send(HELLO)
            await socket.send(frame)
            await socket.close()

    async def all_of_them():
        for _ in range(rounds):
            await asyncio.gather(*(one() for _ in range(8)))

    asyncio.run(all_of_them())


def test_a_thousand_malformed_messages_crash_nothing_and_move_nothing(site):
    rng = np.random.default_rng(0)
    with site.page() as ada:
        before = ada.state
        storm(site, 75, rng)
        assert site.control.alive
        assert way_m(before, ada.state) == 0.0
        assert ada.state["phase"] == "disengaged"
        # While she drives they stop the arm. She can drive on.
        for _ in range(5):
            ada.drive(1.0, 0.0)
            storm(site, 10, rng)
            at_rest(ada)
            assert site.control.alive
            assert ada.closed is None
            assert ada.state["you"]
        ada.drive(1.0, 0.0)


def post(site, path, **headers):
    request = urllib.request.Request(f"{site.origin}{path}", method="POST", headers=headers)  # noqa: S310
    with urllib.request.urlopen(request, timeout=5) as answer:  # noqa: S310
        return answer.status


def test_stop_works_without_a_socket(site):
    with site.page() as ada:
        ada.drive(1.0, 0.0)
        with pytest.raises(urllib.error.HTTPError):
            post(site, "/stop")
        assert ada.state["phase"] == "moving"
        assert post(site, "/stop", Origin=site.origin) == 204
        at_rest(ada)


def get(site, path):
    with urllib.request.urlopen(f"{site.origin}{path}", timeout=5) as answer:  # noqa: S310
        return answer.read()


def test_the_scene_has_a_pose_for_every_body(site, setup):
    scene = json.loads(get(site, "/scene.json"))
    with site.page() as page:
        poses = np.array(page.state["bodies"])
    assert len(scene["bodies"]) == len(poses) == setup.task.robot.dof + 1
    np.testing.assert_allclose(np.linalg.norm(poses[:, 3:], axis=1), 1.0, atol=1e-3)
    parts = [*scene["bodies"], *scene["fingers"]]
    drawn = setup.task.robot.model().geom_group < SHELL_GROUP
    assert sum(len(part["geoms"]) for part in parts) == drawn.sum()
    meshes = {geom["mesh"] for part in parts for geom in part["geoms"]} - {None}
    assert meshes
    for number in meshes:
        vertices, faces = np.frombuffer(get(site, f"/mesh/{number}")[:8], dtype="<u4")
        assert len(get(site, f"/mesh/{number}")) == 8 + 12 * (vertices + faces)
    with pytest.raises(urllib.error.HTTPError):
        get(site, "/mesh/1000")
