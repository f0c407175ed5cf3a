"""Parts of the xArm driver that need no arm."""

import socket
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arms.xarm_rig import xarm7
from latentarm.arms.address import parse_address
from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.contract import check_arm
from latentarm.arms.xarm.control_socket import ControlSocket
from latentarm.arms.xarm.controller import LinkLostError
from latentarm.arms.xarm.gripper import units_of, width_of
from latentarm.arms.xarm.identity import read_identity
from latentarm.arms.xarm.reports import JointReport, ReportClock
from latentarm.arms.xarm.sdk import load_sdk
from latentarm.arms.xarm.session import read_options
from latentarm.arms.xarm.watch import Watch
from latentarm.arms.xarm.words import controller_error, emergency_stop
from latentarm.core.errors import UserError

GRIPPER = xarm7().gripper


def test_it_is_found_by_its_scheme_and_fits_its_robot() -> None:
    robot = xarm7()
    arm = make_real_arm("xarm://192.168.1.203", robot, lambda: 0.0)
    check_arm(arm.spec, robot)
    assert arm.status().phase == "off"
    with pytest.raises(RuntimeError, match="connected"):
        arm.read()


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("speed=1", "does not know the option speed"),
        ("load=heavy", "takes load=none"),
        ("status_port=0", "ports are 1 to 65535"),
        ("status_port=x", "ports are 1 to 65535"),
    ],
)
def test_an_option_that_means_nothing_is_refused(query: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        read_options(parse_address(f"xarm://1.2.3.4?{query}"))


@given(st.integers(0, 99), st.integers(0, 99), st.integers(0, 99), st.sampled_from([5, 6, 7]))
def test_any_version_is_read(major: int, minor: int, patch: int, axes: int) -> None:
    told = read_identity(f"{axes},{axes},XI1304,AC1303,v{major}.{minor}.{patch}")
    assert (told.firmware, told.axes) == ((major, minor, patch), axes)
    assert read_identity(f"v{major}.{minor}.{patch}").axes is None


@given(st.text("v,XI 0.", max_size=40).filter(lambda text: text.count(".") < 2))
def test_what_is_no_version_is_refused(text: str) -> None:
    with pytest.raises(LinkLostError, match="firmware version"):
        read_identity(text)


@given(st.floats(0.0, 0.085))
def test_an_opening_survives_the_grippers_units(width_m: float) -> None:
    assert GRIPPER is not None
    assert abs(width_of(units_of(width_m, GRIPPER), GRIPPER) - width_m) <= 0.085 / 850 / 2 + 1e-12


def test_every_error_of_the_manufacturer_becomes_one_sentence() -> None:
    sdk = load_sdk()
    codes = [code for code in sdk.errors if isinstance(code, int)]
    sentences = [emergency_stop(c) if c <= 3 else controller_error(sdk, c) for c in codes]
    assert len(codes) > 30
    assert all(sentence.endswith(".") and "enable" in sentence for sentence in sentences)


@given(st.lists(st.floats(0.0, 0.1), min_size=2, max_size=50))
def test_reports_that_are_held_up_are_as_old_as_they_are(delays_s: list[float]) -> None:
    clock = ReportClock()
    for index, delay_s in enumerate([0.0, *delays_s]):
        measured_s = 0.005 * index
        told_s = clock.measured_s(measured_s + delay_s, measured_s + delay_s, measured_s + 77.0)
        assert told_s == pytest.approx(measured_s, abs=2e-3)
    assert clock.fault == ""


@pytest.mark.parametrize(
    ("ours_s", "theirs_s", "said"),
    [(0.0, 0.2, "jumped forward by 0.2 s"), (0.0, -2.0, "jumped back"), (0.3, 0.0, "computer's clock")],
)
def test_a_clock_that_jumps_is_found(ours_s: float, theirs_s: float, said: str) -> None:
    clock = ReportClock()
    for index in range(100):
        late = index >= 50
        at_s = 0.005 * index
        clock.measured_s(at_s + late * ours_s, at_s, 5.0 + at_s + late * theirs_s)
    assert said in clock.fault


def _report(at_s: float, q: np.ndarray, dq: np.ndarray | None = None, mode: int = 4) -> JointReport:
    return JointReport(q, np.zeros(2) if dq is None else dq, mode, 1, at_s, at_s, None, 0)


@pytest.mark.parametrize("lag_s", [0.0, 0.05, 0.1])
def test_an_arm_that_lags_is_not_frozen_and_one_that_never_moves_is(lag_s: float) -> None:
    watch = Watch(("a", "b"))
    watch.reset(0.0)
    said: dict[str, str] = {}
    for moves in (True, False):
        for index in range(40):
            at_s = 0.005 * index + (0.0 if moves else 10.0)
            watch.commanded(np.array([0.3, 0.0]), at_s + 0.025)
            angle = 0.3 * max(0.0, 0.005 * index - lag_s) if moves else 1.0
            said[str(moves)] = watch.fault(_report(at_s, np.array([angle, 0.0])))
    assert said["True"] == ""
    assert "'a' does not change" in said["False"]


@pytest.mark.parametrize("frame", [b"\0\1\0\2\0\0", b"\0\1\0\2\xff\xff" + b"x" * 80, b""])
def test_bytes_that_are_no_frame_end_the_connection(frame: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            made, _ = server.accept()
            made.sendall(frame)
            made.close()

        thread = threading.Thread(target=answer)
        thread.start()
        port = ControlSocket("127.0.0.1", server.getsockname()[1], timeout_s=1.0, undelivered_s=0.1)
        thread.join()
        assert port.read(0.5) == -1
        assert not port.connected
        assert port.write(b"x") == -1
