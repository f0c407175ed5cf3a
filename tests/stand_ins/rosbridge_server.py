"""A server that speaks the rosbridge v2 protocol, with the real watchdog next to a simulated arm.

It serves what the driver needs of ROS 2: joint states, a controller, the controller manager's list, a
gripper's action, and the watchdog's two topics. The messages are those of ``ROSBRIDGE_PROTOCOL.md``; the
decisions of the watchdog are those of the published file, which is loaded as it is.
"""

import asyncio
import contextlib
import importlib.util
import json
import math
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from ros2_controllers import SimulatedController, SimulatedGripper
from scipy.spatial.transform import Rotation
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm.testing.real_arms import StandIn

WATCHDOG_FILE: Final = Path(__file__).parents[2] / "docs" / "your-arm" / "latentarm_watchdog.py"
GRIPPER_JOINT: Final = "finger_joint"
PERIOD_S: Final = 0.01
_MOST_WAITING: Final = 100


def load_watchdog() -> Any:
    """The published file as a module."""
    spec = importlib.util.spec_from_file_location("latentarm_watchdog", WATCHDOG_FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass(frozen=True)
class Setup:
    """What the server is to be.

    Attributes:
        kind: of the controller.
        watchdog: whether there is one.
        version: that the watchdog claims to have; None for its own.
        stop_topic: of the emergency stop.
        controller: its name.
        rate_hz: of the joint states.
        describes: whether ``/robot_description`` is published.
        frames: whether ``/tf`` is.
    """

    kind: str = "velocity"
    watchdog: bool = True
    version: int | None = None
    stop_topic: str = "/stop"
    controller: str = "arm_controller"
    rate_hz: float = 100.0
    describes: bool = True
    frames: bool = True


class _Client:
    """One connection, and what it wants to hear."""

    def __init__(self, connection: ServerConnection) -> None:
        self.connection = connection
        self.topics: set[str] = set()
        self.waiting: asyncio.Queue[str] = asyncio.Queue(_MOST_WAITING)

    def send(self, message: dict[str, Any]) -> None:
        if self.waiting.full():
            self.waiting.get_nowait()  # the oldest is dropped, as by rosbridge
        self.waiting.put_nowait(json.dumps(message))


class RosbridgeServer(StandIn):
    """The server, in a thread of its own. As a context manager it runs until the end.

    Args:
        robot: the arm.
        setup: what there is about it.

    Attributes:
        port: where it listens, on the loopback address.
    """

    def __init__(self, robot: Robot, setup: Setup | None = None) -> None:
        self.setup = setup or Setup()
        self._robot = robot
        now_s = time.monotonic()
        self.arm = SimulatedController(robot.home, robot.limits.lower, robot.limits.upper, now_s)
        width_m = 0.08 if robot.gripper is None else robot.gripper.width_m
        self.gripper = SimulatedGripper(width_m, 0.1, now_s)
        self._names = list(robot.joint_names)
        self._order = self._names[::-1]  # of the controller: never that of the joint states
        self._module = load_watchdog()
        self.start_watchdog()
        self.goals = self.aborted = 0
        self.publishers = 1
        self.told: list[str] = []  # what clients have told ROS: topics, services and actions
        self.clock_s = time.time() - now_s
        self.states_as: str = "good"
        self._stamp_s = now_s + self.clock_s
        self._told = (self.arm.q.tolist(), self.arm.dq.tolist())
        self.gripper_fails = False
        self._clients: set[_Client] = set()
        self._goal: tuple[_Client, dict[str, Any]] | None = None
        self._loop: asyncio.AbstractEventLoop
        self._ended = asyncio.Event()
        self._listening = threading.Event()
        self._uncut = asyncio.Event()
        self._uncut.set()
        self._thread = threading.Thread(target=self._run, name="rosbridge", daemon=True)
        self.port = 0

    def __enter__(self) -> "RosbridgeServer":
        self._thread.start()
        assert self._listening.wait(10.0)
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join(10.0)

    # What a test does to it

    @property
    def address(self) -> str:
        """Of the arm behind it."""
        finger = "" if self._robot.gripper is None else f"&gripper_joint={GRIPPER_JOINT}"
        return (
            f"ros2://127.0.0.1:{self.port}?controller={self.setup.controller}&kind={self.setup.kind}{finger}"
        )

    def positions(self) -> FloatArray:
        """Where the joints are, (n,), rad."""
        return self.arm.q.copy()

    def press_emergency_stop(self) -> None:
        """The hardware stops at once, and says so."""
        self._do(lambda: self._stop_button(pressed=True))

    def release_emergency_stop(self) -> None:
        """The hardware obeys its controller again."""
        self._do(lambda: self._stop_button(pressed=False))

    def break_down(self) -> None:
        """The controller ends, as after a fault of the hardware, and is started again."""
        self.restart_controller(0.3)

    def restart_controller(self, for_s: float) -> None:
        """The controller is inactive for a while."""
        self._do(lambda: self.arm.switch(active=False, now_s=time.monotonic()))
        self._loop.call_soon_threadsafe(
            self._loop.call_later, for_s, lambda: self.arm.switch(active=True, now_s=time.monotonic())
        )

    def cut(self) -> None:
        """Nothing passes in either direction; what is sent waits, as in a network."""
        self._do(self._uncut.clear)

    def repair(self) -> None:
        """What has waited arrives all at once."""
        self._do(self._uncut.set)

    def set_states(self, how: str) -> None:
        """Joint states are ``good``, ``none``, ``frozen``, ``repeated``, ``nan`` or ``missing`` one."""
        self.states_as = how

    def jump_clock(self, by_s: float) -> None:
        """The clock of ROS is set."""
        self.clock_s += by_s

    def publish(self, topic: str, message: dict[str, Any]) -> None:
        """Another node's message to all that have subscribed."""
        self._do(lambda: self._publish(topic, message))

    def start_watchdog(self) -> None:
        """Start the watchdog, again."""
        module, limits = self._module, self._robot.limits
        joints = tuple(
            module.Joint(name, float(speed), float(rise))
            for name, speed, rise in zip(self._names, limits.velocity, limits.acceleration, strict=True)
        )[::-1]
        guarded = module.Arm(f"/{self.setup.controller}", self.setup.kind, joints, self.setup.stop_topic)
        self.watchdog = module.Watchdog(guarded) if self.setup.watchdog else None
        self._targets = module.Targets()
        if self.watchdog is not None and self.setup.stop_topic:
            self.watchdog.emergency_stop(False)

    def _do(self, what: Any) -> None:
        """Have something done in the server's thread, and wait for it."""
        done = threading.Event()

        def act() -> None:
            what()
            done.set()

        self._loop.call_soon_threadsafe(act)
        assert done.wait(5.0)

    def _stop_button(self, *, pressed: bool) -> None:
        self.arm.advance(time.monotonic())
        self.arm.stop_pressed = pressed
        if self.watchdog is not None:
            self.watchdog.emergency_stop(pressed)

    # The server itself

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        async with serve(self._attend, "127.0.0.1", 0, compression=None, ping_interval=None) as server:
            self.port = next(iter(server.sockets)).getsockname()[1]
            self._listening.set()
            ticking = asyncio.create_task(self._tick())
            await self._ended.wait()
            self._uncut.set()
            ticking.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await ticking

    async def _attend(self, connection: ServerConnection) -> None:
        client = _Client(connection)
        self._clients.add(client)
        sending = asyncio.create_task(self._send(client))
        with contextlib.suppress(ConnectionClosed):
            async for text in connection:
                await self._uncut.wait()
                self._take(client, json.loads(text))
        self._clients.discard(client)
        sending.cancel()

    async def _send(self, client: _Client) -> None:
        with contextlib.suppress(ConnectionClosed):
            while True:
                text = await client.waiting.get()
                await self._uncut.wait()
                await client.connection.send(text)

    def _take(self, client: _Client, message: dict[str, Any]) -> None:
        match message["op"]:
            case "subscribe":
                client.topics.add(message["topic"])
                if message["topic"] == "/robot_description" and self.setup.describes:
                    description = {"data": description_of(self._robot)}
                    client.send({"op": "publish", "topic": message["topic"], "msg": description})
            case "unsubscribe":
                client.topics.discard(message["topic"])
            case "publish":
                self.told.append(message["topic"])
                if message["topic"] == "/latentarm_watchdog/command" and self.watchdog is not None:
                    self.watchdog.heard(message["msg"]["data"], time.monotonic())
            case "call_service":
                self.told.append(message["service"])
                known = message["service"] == "/controller_manager/list_controllers"
                client.send(
                    {
                        "op": "service_response",
                        "id": message["id"],
                        "service": message["service"],
                        "values": {"controller": self.controllers()} if known else "no such service",
                        "result": known,
                    }
                )
            case "send_action_goal":
                self.told.append(message["action"])
                self._take_goal(client, message)
            case "cancel_action_goal":
                if self._goal is not None and self._goal[1]["id"] == message["id"]:
                    self.gripper.goal_m = self.gripper.opening_m
                    self._end_goal(5)
            case _:
                pass

    def controllers(self) -> list[dict[str, Any]]:
        """As the controller manager lists them."""
        velocity = self.setup.kind == "velocity"
        needed = [f"{name}/{'velocity' if velocity else 'position'}" for name in self._order]
        kinds = {
            "velocity": "forward_command_controller/ForwardCommandController",
            "trajectory": "joint_trajectory_controller/JointTrajectoryController",
        }
        return [
            {
                "name": "joint_state_broadcaster",
                "state": "active",
                "type": "joint_state_broadcaster/JointStateBroadcaster",
                "claimed_interfaces": [],
                "required_command_interfaces": [],
            },
            {
                "name": self.setup.controller,
                "state": "active" if self.arm.active else "inactive",
                "type": kinds[self.setup.kind],
                "claimed_interfaces": needed if self.arm.active else [],
                "required_command_interfaces": needed,
            },
        ]

    def _take_goal(self, client: _Client, message: dict[str, Any]) -> None:
        if self._goal is not None:
            self._end_goal(5)
        self._goal = (client, message)
        self.goals += 1
        if self.gripper_fails:
            self._end_goal(6)
        else:
            self.gripper.goal_m = float(message["args"]["command"]["position"])

    def _end_goal(self, status: int) -> None:
        assert self._goal is not None
        (client, message), self._goal = self._goal, None
        self.aborted += status == 6
        client.send(
            {
                "op": "action_result",
                "action": message["action"],
                "id": message["id"],
                "values": {
                    "position": self.gripper.opening_m,
                    "effort": message["args"]["command"]["max_effort"],
                    "stalled": self.gripper.stalled,
                    "reached_goal": self.gripper.reached,
                },
                "status": status,
                "result": True,
            }
        )

    async def _tick(self) -> None:
        """What happens in ROS: every 5 ms physics, every 10 ms the rest."""
        count, due_s, told_s, stated_s = 0, time.monotonic(), -math.inf, -math.inf
        while True:
            count += 1
            due_s = max(due_s + PERIOD_S / 2, time.monotonic() - PERIOD_S)
            await asyncio.sleep(due_s - time.monotonic())
            now_s = time.monotonic()
            self.arm.advance(now_s)
            if count % 2:
                continue
            self.gripper.advance(now_s)
            if self._goal is not None and (self.gripper.reached or self.gripper.stalled):
                self._end_goal(4)
            if now_s - stated_s > 1.0 / self.setup.rate_hz - PERIOD_S / 2:
                stated_s = now_s
                self._tell_joint_states(now_s)
                if self.setup.frames and count % 20 == 0:
                    self._publish("/tf", {"transforms": frames_of(self._robot, self.arm.q)})
            if self.watchdog is not None:
                if count % 20 == 0:
                    self.watchdog.controllers(
                        [
                            (one["name"], one["state"], one["required_command_interfaces"])
                            for one in self.controllers()
                        ],
                        now_s,
                    )
                    self.watchdog.publishers(self.publishers)
                self._command(self.watchdog.tick(now_s), now_s)
                if now_s - told_s > 0.015:
                    told_s = now_s
                    self._publish("/latentarm_watchdog/state", {"data": self._state(now_s)})

    def _state(self, now_s: float) -> str:
        assert self.watchdog is not None
        text: str = self.watchdog.state(now_s)
        if self.setup.version is not None:
            text = json.dumps({**json.loads(text), "latentarm_watchdog": self.setup.version})
        return text

    def _command(self, velocity: tuple[float, ...] | None, now_s: float) -> None:
        if velocity is None or self.watchdog is None:
            return
        if self.setup.kind == "velocity":
            self.arm.command(velocity[::-1], now_s)
        elif self.watchdog.measured is not None:
            points = self._targets.points(velocity, self.watchdog.measured, now_s)
            told = [(np.array(q[::-1]), np.array(dq[::-1]), after_s) for q, dq, after_s in points]
            self.arm.follow(told, now_s)

    def _tell_joint_states(self, now_s: float) -> None:
        """In alphabetical order, as ROS does it."""
        if self.states_as == "none":
            return
        if self.states_as != "repeated":
            self._stamp_s = now_s + self.clock_s
        if self.states_as not in ("frozen", "repeated"):
            self._told = (self.arm.q.tolist(), self.arm.dq.tolist())
        q, dq = (dict(zip(self._names, figures, strict=True)) for figures in self._told)
        q[GRIPPER_JOINT], dq[GRIPPER_JOINT] = self.gripper.opening_m, 0.0
        if self.states_as == "nan":
            q[self._names[0]] = math.nan
        if self.states_as == "missing":
            del q[self._names[-1]]
        names = sorted(q)
        if self.watchdog is not None:
            self.watchdog.joint_states(self._stamp_s, names, [q[name] for name in names], now_s)
        whole_s = math.floor(self._stamp_s)
        message = {
            "header": {
                "stamp": {"sec": whole_s, "nanosec": round(1e9 * (self._stamp_s - whole_s))},
                "frame_id": "",
            },
            "name": names,
            "position": [None if math.isnan(q[name]) else q[name] for name in names],
            "velocity": [dq[name] for name in names],
            "effort": [],
        }
        self._publish("/joint_states", message)

    def _publish(self, topic: str, message: dict[str, Any]) -> None:
        for client in self._clients:
            if topic in client.topics:
                client.send({"op": "publish", "topic": topic, "msg": message})


def description_of(robot: Robot) -> str:
    """The robot as a URDF without shapes."""
    chain, limits = robot.chain, robot.limits
    assert not chain.anchor.any()
    links, joints = ['<link name="base"/>'], []

    def placed(frame: FloatArray) -> str:
        turn = Rotation.from_matrix(frame[:3, :3]).as_euler("xyz")
        numbers = [" ".join(repr(float(one)) for one in row) for row in (frame[:3, 3], turn)]
        return f'<origin xyz="{numbers[0]}" rpy="{numbers[1]}"/>'

    for i, name in enumerate(chain.joint_names):
        parent = "base" if chain.parent[i] < 0 else f"link{chain.parent[i] + 1}"
        axis = " ".join(repr(float(one)) for one in chain.axis[i])
        ends = f'lower="{limits.lower[i]}" upper="{limits.upper[i]}" velocity="{limits.velocity[i]}"'
        links.append(f'<link name="link{i + 1}"/>')
        joints.append(
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="link{i + 1}"/>'
            f'{placed(chain.offset[i])}<axis xyz="{axis}"/><limit {ends} effort="1"/></joint>'
        )
    tool = chain.tools[0]
    links.append(f'<link name="{tool.name}"/>')
    joints.append(
        f'<joint name="mount" type="fixed"><parent link="link{tool.link + 1}"/><child link="{tool.name}"/>'
        f"{placed(tool.transform)}</joint>"
    )
    return f'<robot name="{robot.name}">{"".join(links)}{"".join(joints)}</robot>'


def frames_of(robot: Robot, q: FloatArray) -> list[dict[str, Any]]:
    """The transforms of ``/tf``, each link in the one before."""
    links, tool = robot.chain.link_transforms(q), robot.chain.tools[0]
    found = []
    for i, parent in enumerate([*robot.chain.parent, tool.link]):
        is_tool = i == len(links)
        above = np.eye(4) if parent < 0 else links[parent]
        frame = tool.transform if is_tool else np.linalg.inv(above) @ links[i]
        turn = Rotation.from_matrix(frame[:3, :3]).as_quat()
        found.append(
            {
                "header": {"frame_id": "base" if parent < 0 else f"link{parent + 1}"},
                "child_frame_id": tool.name if is_tool else f"link{i + 1}",
                "transform": {
                    "translation": dict(zip("xyz", frame[:3, 3].tolist(), strict=True)),
                    "rotation": dict(zip("xyzw", turn.tolist(), strict=True)),
                },
            }
        )
    return found


@contextlib.contextmanager
def silent_port() -> Iterator[int]:
    """A port that takes connections and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        yield listening.getsockname()[1]
