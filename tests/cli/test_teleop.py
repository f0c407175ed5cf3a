"""What `latentarm teleop` says before it serves."""

import socket

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
    ],
)
def test_what_the_user_can_fix_is_one_sentence(run, workplace, words, said):
    code, _, err = run("teleop", *words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
