"""What `latentarm teleop` says before it serves."""

import socket
from pathlib import Path

import pytest


def test_a_port_in_use_is_said(run):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        code, out, err = run("teleop", "--port", port)
    assert code == 2
    assert f"127.0.0.1 port {port} cannot be used" in err
    assert out == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], "nowhere is not a run"),
        (["--host", "0.0.0.0"], "name this machine's own address"),  # noqa: S104 - it is refused
        (["--host", "::"], "name this machine's own address"),
        (["--host", "no.such.host.invalid"], "is not an address of this machine"),
        (["--host", "192.0.2.1"], "cannot be used"),
        (["--port", "70000"], "from 0 to 65535"),
        (["--profile", "ada"], "A profile belongs to a run"),
        (["--certfile", "cert.pem"], "name both --certfile and --keyfile"),
        (["--certfile", "cert.pem", "--keyfile", "key.pem"], "not a certificate and key for TLS"),
        (["--seed", "-1"], "seed"),
        (["--zones", "nowhere.toml"], "nowhere.toml"),
        (["--camera", "front=/dev/video77"], "Camera front: the device does not exist"),
        (["--camera", "front=nowhere.mp4"], "Camera front: the file does not exist"),
        (["--camera", "testsrc"], "Camera 1 is not NAME=ADDRESS"),
        (["--camera", "a=testsrc", "--camera", "A=testsrc"], "Two cameras are called A"),
    ],
)
def test_what_the_user_can_fix_is_one_sentence(run, workplace, words, said):
    code, _, err = run("teleop", *words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1


def test_a_zone_may_not_be_faster_than_the_arm_anywhere(run, workplace):
    Path("zones.toml").write_text(
        '[zones.face]\nshape = "sphere"\ncentre_m = [1, 0, 1]\nradius_m = 0.1\nspeed_m_per_s = 0.3\n'
    )
    code, _, err = run("teleop", "--zones", "zones.toml")
    assert code == 2
    assert "zones.toml: the zone 'face' allows 0.3 m/s, and the arm may do 0.25 m/s anywhere" in err


def test_cameras_need_their_extra(run, workplace, monkeypatch):
    monkeypatch.setattr("latentarm.cameras.sources.find_spec", lambda name: None)
    code, out, err = run("teleop", "--camera", "front=testsrc")
    assert (code, out) == (2, "")
    assert err == "latentarm: --camera needs the extra `camera`: pip install 'latentarm[camera]'.\n"
