"""`latentarm guide` prints pages and files, and what our messages point to is there."""

import re

from documentation import ROOT
from latentarm.cli import main


def listed(capsys):
    assert main(["guide"]) == 0
    return capsys.readouterr().out.split()


def test_a_file_is_printed_as_it_is(capsys):
    assert {"your-arm", "franka", "zones.toml", "latentarm_watchdog.py", "latentarm@.service"} <= set(
        listed(capsys)
    )
    assert main(["guide", "zones.toml"]) == 0
    assert capsys.readouterr().out == (ROOT / "docs/your-arm/zones.toml").read_text()


def test_a_page_shows_the_files_that_it_includes(capsys):
    for name in listed(capsys):
        assert main(["guide", name]) == 0
        assert "8<--" not in capsys.readouterr().out
    assert main(["guide", "objects"]) == 0
    assert (ROOT / "examples/your_own_detector.py").read_text().rstrip() in capsys.readouterr().out


def test_another_name_is_refused(capsys):
    assert main(["guide", "hammer"]) == 2
    assert "There is no hammer: name one of your-arm, arms," in capsys.readouterr().err


def test_every_message_points_to_a_page_that_is_there_without_a_clone(capsys):
    texts = [path.read_text() for path in (ROOT / "src/latentarm").rglob("*.py")]
    named = {name for text in texts for name in re.findall(r"`latentarm guide ([^`]+)`", text)}
    assert len(named) >= 6
    assert named <= set(listed(capsys))
    assert not [text for text in texts if re.search(r"see docs/[a-z-]+\.md", text)]
