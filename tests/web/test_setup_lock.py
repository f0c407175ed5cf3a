"""Where the host has locked Set up, the server takes no change of how the arm behaves, whatever is sent."""

import time

import httpx
import pytest

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.records.people import People


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("teleop")


@pytest.fixture(scope="module")
def ada(folder):
    """A person who has chosen a lot of help."""
    return People(folder / "records" / "people").add("Ada", {"help": "high"}).id


@pytest.fixture(scope="module")
def locked(serve, trained, folder, ada):
    with serve(Spec(trained, out=folder), locked=True) as site:
        yield site


def test_a_guest_changes_neither_help_nor_directions_nor_poses_nor_what_is_learned(locked):
    chosen = {"file": "1.journal", "episode": 1}
    with locked.page() as guest:
        guest.send(type="ask_to_drive")
        guest.wait(lambda state: state["you"])
        guest.send(type="help", level="high")
        guest.send(type="profile", name="mia", seat="behind")
        guest.send(type="save_pose", name="Here")
        guest.send(type="train", name="mine", model="pca", latent_dim=2, episodes=[chosen])
        guest.send(type="personalise", name="mia", questions=5)
        # What the stick moves now is no part of Set up.
        guest.send(type="mode", mode="end_effector", axes=1)
        guest.wait(lambda state: state["axes"] == 1)
        time.sleep(0.2)
        assert (guest.state["help"], guest.state["profile"]) == ("medium", None)
        assert guest.poses == []
        assert guest.learning["training"] is None
        assert guest.learning["personalise"] is None


def test_what_a_person_has_kept_counts_and_stays(locked, ada):
    with locked.page(person=ada) as page:
        page.send(type="ask_to_drive")
        page.wait(lambda state: state["you"])
        page.send(type="help", level="high")
        page.wait(lambda state: state["help"] == "high")
        page.send(type="help", level="low")
        time.sleep(0.2)
        assert page.state["help"] == "high"
    with httpx.Client(base_url=locked.origin, headers={"origin": locked.origin}) as client:
        kept = f"/records/people/{ada}/settings"
        assert client.put(kept, json={"help": "low"}).json()["notice"]["code"] == "setup_locked"


def test_the_page_says_that_it_is_locked_and_leads_nowhere_else(locked):
    with httpx.Client(base_url=locked.origin) as client:
        html = client.get("/", headers={"accept-language": "en"}).text
        assert "Settings are locked" in html
        assert '<a href="/teach"' not in html
        assert client.get("/teach").status_code == 404
