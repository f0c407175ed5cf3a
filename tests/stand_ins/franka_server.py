"""A stand-in for a Franka: franky-sim in a process of its own, with what it leaves out of the real arm.

franky-sim 1.0.4 speaks the arm's protocol over MuJoCo, gripper included. Added here, in its own terms: a stop
button, reflexes and how they are recovered from, the arm's stop after cycles without a message (only while a
test cuts the network, because a busy machine is late), the hand's answer to a move that it was told to
stop, and external torques, for which franky-sim gives those of the motors: here a person's push alone. Left
out are contacts that the real arm does not have. No limits are enforced.

As a program (``python franka_server.py HOST``) it takes orders by line on standard
input and answers in JSON; `FrankaStandIn` is its other end.
"""

import json
import queue
import subprocess
import sys
import threading
import time
from typing import ClassVar

import numpy as np

from latentarm.core.punctuality import short_collections

START = (0.0, -0.785398, 0.0, -2.356194, 0.0, 1.570796, 0.785398)
"""Where the joints are at first, rad."""

LOST_CYCLES = 20
"""The real arm stops after so many cycles of 1 ms without a message."""

STIFFNESS = (4500.0, 4500.0, 3500.0, 3500.0, 2000.0, 2000.0, 1000.0)
DAMPING = (450.0, 450.0, 350.0, 350.0, 200.0, 200.0, 100.0)
"""Those of franky-sim, but for the last joint, which trembles by 0.1 rad/s with its own."""

_PULL, _HELD_BACK, _STRENGTH = 60.0, 10.0, 5.0
"""Of a person's hand: N m/rad, N m s/rad, N m."""

_FOREARM = 2
"""The bit of a kind of contact that MuJoCo's models leave free."""

_JOINT_REFLEX = 6
_COMMUNICATION = 25


class FrankaStandIn:
    """The stand-in, from the outside.

    Args:
        host: loopback address to listen on, one that nobody else uses.
    """

    def __init__(self, host: str) -> None:
        self.host = host
        self.start()

    def start(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__, self.host],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
        )
        self._lock = threading.Lock()
        self._answer()

    def kill(self) -> None:
        """Cut the arm's power."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            pipe.close()

    def close(self) -> None:
        if self._process.poll() is None:
            self.kill()

    def __enter__(self) -> "FrankaStandIn":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def ask(self, order: str) -> dict:
        with self._lock:
            self._process.stdin.write(order + "\n")
            self._process.stdin.flush()
            return self._answer()

    def _answer(self) -> dict:
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the stand-in has ended")
        return json.loads(line)

    def positions(self) -> np.ndarray:
        return np.array(self.ask("state")["q"])

    def wait(self, for_s: float) -> None:
        """Until so much of the arm's own time has passed."""
        end_s = self.time_s() + for_s
        while self.time_s() < end_s:
            time.sleep(0.01)

    def time_s(self) -> float:
        return self.ask("state")["t"]

    def press_emergency_stop(self) -> None:
        self.ask("press")

    def release_emergency_stop(self) -> None:
        self.ask("release")

    def break_down(self) -> None:
        self.ask("break")

    def commands(self) -> list[str]:
        """Every command to arm or hand since it was switched on, by its name in the arm's protocol."""
        return self.ask("told")["told"]

    def begin_push(self, by: np.ndarray) -> None:
        self.ask("push " + " ".join(map(str, self.positions() + by)))

    def push(self, by: np.ndarray) -> None:
        self.begin_push(by)
        self.wait(1.5)
        self.ask("push")
        self.wait(0.5)  # an arm that holds its position springs back

    def cut(self) -> None:
        self.ask("cut")

    def repair(self) -> None:
        self.ask("repair")


def patient_driver(robot, address, now_s):
    """The driver, for a stand-in whose clock is slower than ours on a small machine."""
    from latentarm.arms.franka import pace
    from latentarm.arms.franka.arm import FrankaArm

    pace._LEAST = 0.02
    return FrankaArm(robot, address, now_s)


class _Noted(dict):
    """Classes of commands by kind, looked up once for each command that comes."""

    told: ClassVar[list[str]] = []

    def get(self, kind):
        self.told.append(kind.name)
        return super().get(kind)


def _servers():
    """The classes of franky-sim with what is added to them."""
    from franky_sim import franka_gripper_server, franka_robot_server, simulation_server
    from franky_sim.franka_gripper_protocol import GripperCommandStatus
    from franky_sim.franka_robot_protocol import (
        AutomaticErrorRecoveryCommand,
        BaseCommand,
        MoveStatus,
        RobotCommand,
        RobotMode,
    )

    class Recovery(AutomaticErrorRecoveryCommand):
        def handle(self, server):
            if not server.pressed:
                server.errors = ()
            super().handle(server)

    class HandServer(franka_gripper_server.FrankaGripperServer):
        def __init__(self, robot, hostname):
            super().__init__(robot, hostname)
            self._FrankaServer__command_class_map = _Noted(self._FrankaServer__command_class_map)

        def stop(self, command_id, tcp_socket):
            # The real hand answers the command that it gives up; franky-sim forgets it.
            if self._pending_command_id is not None:
                BaseCommand.send_response(
                    self._pending_tcp_socket,
                    self._pending_command_type,
                    self._pending_command_id,
                    GripperCommandStatus.kAborted,
                    command_type_struct="H",
                    status_type_struct="H",
                )
            super().stop(command_id, tcp_socket)

    class ArmServer(franka_robot_server.FrankaRobotServer):
        def __init__(self, robot, hostname_candidates):
            self.errors = ()
            self.pressed = self.is_cut = False
            self.silent = 0
            self._heard = False
            super().__init__(robot, hostname_candidates)
            known = self._FrankaServer__command_class_map | {RobotCommand.kAutomaticErrorRecovery: Recovery}
            self._FrankaServer__command_class_map = _Noted(known)

        @property
        def robot_state(self):
            # A real arm says what it exerts on its surroundings.
            pushes = tuple(-self.robot.external_torque)
            state = super().robot_state.replace(tau_ext_hat_filtered=pushes)
            if self.pressed:
                return state.replace(robot_mode=RobotMode.kUserStopped)
            if self.errors:
                flags = tuple(index in self.errors for index in range(41))
                return state.replace(robot_mode=RobotMode.kReflex, errors=flags, reflex_reason=flags)
            return state

        def start_motion(self, *arguments):
            if self.pressed or self.errors:
                raise RuntimeError("the arm takes no commands")
            self.silent, self._heard = 0, False
            super().start_motion(*arguments)

        def abort(self, status):
            motion = self.current_motion_id
            self.stop_motion(send_preemption_signal=False)
            if motion:
                self.send_state()
                BaseCommand.send_response(self._tcp_socket, RobotCommand.kMove, motion, status)
                self.reset_current_motion_id()

        def _handle_udp_command(self, command_data):
            self.silent, self._heard = 0, True
            super()._handle_udp_command(command_data)

        def process_commands(self):
            if self.is_cut:
                # Nothing comes in; the arm goes on with what it has.
                self._pre_process_commands()
                self._post_process_commands()
            else:
                super().process_commands()
            if not self.current_motion_id or not self._heard:
                return
            self.silent += 1
            if self.is_cut and self.silent > LOST_CYCLES:
                self.errors = (_COMMUNICATION,)
                self.abort(MoveStatus.kReflexAborted)

        def send_state(self):
            if not self.is_cut:
                super().send_state()

        def press(self):
            self.pressed = True
            self.abort(MoveStatus.kEmergencyAborted)

        def collide(self):
            self.errors = (_JOINT_REFLEX,)
            self.abort(MoveStatus.kReflexAborted)

    franka_robot_server.FrankaGripperServer = HandServer
    simulation_server.FrankaRobotServer = ArmServer
    return simulation_server.SimulationServer


def part_forearm(model) -> None:
    """Let the flange and the hand pass through the forearm's convex hull, which is what MuJoCo takes.

    The hull fills the bend of the forearm, so both touch it near the lower end of joint 6. The manufacturer's
    own meshes stay 22 mm (flange) and 34 mm (hand) apart there, however joint 7 is turned.
    """
    forearm, apart = model.body("robot0_fr3_link5").id, ("robot0_fr3_link7", "robot0_hand")
    for bodies, kinds, others in (
        (model.geom_bodyid, model.geom_contype, model.geom_conaffinity),
        (np.arange(model.nbody), model.body_contype, model.body_conaffinity),
    ):
        solid = kinds != 0
        others[solid & ~np.isin(bodies, [model.body(name).id for name in apart])] |= _FOREARM
        kinds[solid & (bodies == forearm)] = others[solid & (bodies == forearm)] = _FOREARM


class _Hand:
    """A person's, that pushes the joints towards where it wants them, as hard as a hand can."""

    def __init__(self, robot) -> None:
        self.goal: np.ndarray | None = None
        self._robot, self._drive = robot, robot._torque_control
        robot._torque_control = self._torque_control
        robot.external_torque = np.zeros(7)

    def _torque_control(self, torques) -> None:
        self._drive(torques)
        pull = np.zeros(7)
        if self.goal is not None and self._robot._data is not None:
            state = self._robot.inner_state
            pull = _PULL * (self.goal - np.array(state.q)) - _HELD_BACK * np.array(state.dq)
            pull = np.clip(pull, -_STRENGTH, _STRENGTH)
            self._robot._data.qfrc_applied[self._robot._dof_addrs] += pull
        self._robot.external_torque = pull


def _obey(order, server, robot, hand, cycle) -> dict:
    arm = server.robot_servers[0]
    name, *rest = order.split()
    answer = {"t": cycle * 1e-3}
    if name == "state":
        answer |= {
            "q": list(robot.inner_state.q),
            "dq": list(robot.inner_state.dq),
            "width": robot.hand_width,
        }
    elif name == "told":
        answer["told"] = _Noted.told
    elif name == "press":
        arm.press()
    elif name == "release":
        arm.pressed = False
    elif name == "break":
        arm.collide()
    elif name == "push":
        hand.goal = np.array(rest, dtype=float) if rest else None
    elif name == "cut":
        arm.is_cut = True
    elif name == "repair":
        arm.is_cut = False
    return answer


def _serve(host: str) -> None:
    simulation_server = _servers()
    from franky_sim.mujoco_simulator import MujocoSimulator

    orders: queue.SimpleQueue[str] = queue.SimpleQueue()

    def listen() -> None:
        for line in sys.stdin:
            orders.put(line.strip())
        orders.put("end")

    threading.Thread(target=listen, daemon=True).start()
    cycle = 0
    with MujocoSimulator() as simulator:
        robot = simulator.add_robot(initial_q=START, kp=STIFFNESS, kv=DAMPING)
        hand = _Hand(robot)
        # An arm's controller never stops to collect garbage.
        with simulation_server(simulator, hostname_candidates=[host]) as server, short_collections():
            part_forearm(robot._model)
            print(json.dumps({"ready": True}), flush=True)  # noqa: T201
            due_s = time.monotonic()
            while True:
                while not orders.empty():
                    order = orders.get()
                    if order == "end":
                        return
                    print(json.dumps(_obey(order, server, robot, hand, cycle)), flush=True)  # noqa: T201
                # As franky-sim's run_once, which gives its processor away in each cycle.
                for arm in server.robot_servers:
                    arm.process_commands()
                simulator.step()
                for arm in server.robot_servers:
                    arm.send_state()
                cycle += 1
                # A late cycle shifts all later ones.
                due_s = max(due_s + 1e-3, time.monotonic())
                if (ahead_s := due_s - time.monotonic()) > 0.0:
                    time.sleep(ahead_s)


if __name__ == "__main__":
    _serve(sys.argv[1])
