"""The stick's frame before anybody has answered."""

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import latentarm.web.pages
from latentarm.alignment.contract import identity
from latentarm.alignment.frame import CAMERAS, FLAT, STEEPEST_RAD_M, StickFrame, fit_frame, right_and_up, view
from latentarm.alignment.frame_file import FRAME_NAME, load_frame, save_frames
from latentarm.alignment.meaning import rotations
from latentarm.alignment.poses import pose_vectors
from latentarm.assistance.controllers.latent import latent_controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot

SEEN = np.array([[0.0, 1.0, 0.0], [-0.42, 0.0, 1.0] / np.hypot(0.42, 1.0)])
"""Right and up of somebody who faces the arm."""


@dataclass(frozen=True)
class Turned:
    """Moves three slides in the view, by a stick that is turned by place and perhaps mirrored."""

    turn: object
    up: float = 1.0
    latent_dim: int = 2

    def decode(self, z, context):
        pushed = np.matvec(np.diag([1.0, self.up]) @ rotations(-self.turn(context)), z)
        return pushed @ SEEN


def spread(seed=0, many=300):
    return np.random.default_rng(seed).uniform(-0.3, 0.3, (many, 3))


def led(decoder, frame, contexts, u):
    """Where pushes lead in the view."""
    return decoder.decode(frame(u, contexts), contexts) @ SEEN.T


@pytest.mark.parametrize("up", [1.0, -1.0])
@pytest.mark.parametrize("middle", [0.0, 2.0, np.pi])
def test_right_leads_right_and_up_leads_up_wherever_the_stick_is_turned(slides, up, middle):
    decoder = Turned(lambda context: middle + 2.0 * context[..., 0] - context[..., 2], up)
    frame = fit_frame(decoder, slides.chain, spread(), "facing")
    elsewhere = spread(1)
    for u in np.concatenate([np.eye(2), -np.eye(2)]):
        before, after = (led(decoder, one, elsewhere, u) @ u for one in (identity, frame))
        assert after.min() > 0.9
        assert after.mean() > 0.995
        assert after.min() > before.min()


@pytest.mark.parametrize("steep", [10.0, 100.0])
def test_a_decoder_that_turns_more_steeply_is_followed_no_more_steeply(slides, steep):
    frame = fit_frame(Turned(lambda context: steep * context[..., 0]), slides.chain, spread(), "facing")
    along = np.linspace(-0.3, 0.3, 601)[:, None] * np.eye(3)[0]
    turned = np.unwrap(np.arctan2(*frame(np.array([0.5, 0.0]), along).T))
    assert np.abs(np.diff(turned)).max() <= STEEPEST_RAD_M * 0.001 + 1e-9


def test_a_person_behind_the_arm_has_other_directions(slides):
    decoder = Turned(lambda context: 0.0 * context[..., 0])
    frame = fit_frame(decoder, slides.chain, spread(), "behind")
    assert (led(decoder, frame, spread(), np.array([1.0, 0.0]))[:, 0] < -0.8).all()


@pytest.mark.parametrize(("seat", "away"), [("facing", [-1.0, 0.0, 0.0]), ("behind", [0.88, 0.48, 0.0])])
def test_up_leads_up_or_away_whichever_the_tool_moves_along(panda, seat, away):
    seen = view(panda.chain.link_transforms(panda.home[None]), seat)
    moves = np.random.default_rng(0).normal(size=(200, 3))
    over_the_table, upright = moves * [1.0, 1.0, 0.01], moves * [0.01, 1.0, 1.0]
    np.testing.assert_allclose(right_and_up(over_the_table, seen)[1], away, atol=0.1)
    assert right_and_up(upright, seen)[1] @ [0.0, 0.0, 1.0] > 0.8


def test_a_flat_arm_is_seen_from_above(arm):
    transforms = arm.chain.link_transforms(np.random.default_rng(0).uniform(-1, 1, (5, 4)))
    for seat in CAMERAS:
        np.testing.assert_allclose(view(transforms, seat), [[1, 0, 0], [0, 1, 0]], atol=0.02)


def test_the_views_are_those_of_the_page():
    source = (Path(latentarm.web.pages.__path__[0]) / "views/aim.js").read_text()
    front = dict(re.findall(r"^  (\w+): \{ front: \[([^]]+)\]", source, re.MULTILINE))
    drawn = {name: tuple(map(float, numbers.split(","))) for name, numbers in front.items()}
    assert drawn == CAMERAS | {"flat": FLAT}


@pytest.fixture(scope="module")
def panda():
    return load_robot("panda")


@pytest.fixture(scope="module")
def wild(panda):
    """Frames of decoders that turn the stick at random from one context to the next."""
    frames = []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        q = panda.home + rng.uniform(-0.6, 0.6, (200, 7))
        angle, columns = rng.uniform(0, 7, 200), rng.normal(size=(7, 2))
        turned = (rotations(angle)[:, None] @ np.eye(2)).squeeze(1)

        class Wild:
            @staticmethod
            def decode(z, context, turned=turned, columns=columns):
                return np.matvec(columns, np.matvec(turned[:, None], np.broadcast_to(z, (200, *z.shape))))

        frames.append(fit_frame(Wild(), panda.chain, q, "facing"))
    return frames


unit = st.floats(-1, 1)


@given(
    number=st.integers(0, 2),
    u=st.tuples(unit, unit),
    q=st.lists(unit, min_size=7, max_size=7),
    move=st.lists(unit, min_size=7, max_size=7),
    size=st.sampled_from([1e-4, 5e-3, 0.1, 1.0]),
)
def test_a_held_push_never_jumps_whatever_the_decoder_does(wild, panda, number, u, q, move, size):
    frame, u = wild[number], np.array(u)
    assert frame.turning.turn_rad.any()
    before = panda.home + 2.0 * np.array(q)
    after = before + size * np.array(move)
    moved = np.linalg.norm(np.subtract(*pose_vectors(panda.chain, np.stack([before, after]))))
    length = np.linalg.norm(u)
    changed = np.linalg.norm(frame(u, after) - frame(u, before))
    assert changed <= STEEPEST_RAD_M * max(length, length**2) * moved + 1e-9


@given(number=st.integers(0, 2), u=st.tuples(unit, unit), q=st.lists(unit, min_size=7, max_size=7))
def test_rest_half_a_push_the_opposite_push_and_its_length_stay(wild, number, u, q):
    frame, u, q = wild[number], np.array(u), np.array(q)
    z = frame(u, q)
    assert np.abs(z).max(initial=0.0) <= 1.0
    np.testing.assert_allclose(frame(-u, q), -z)
    short = u / max(1.0, np.linalg.norm(u))
    whole = frame(short, q)
    np.testing.assert_allclose(frame(0.5 * short, q), 0.5 * whole, atol=1e-15)
    assert np.linalg.norm(whole) == pytest.approx(np.linalg.norm(short))


def test_a_frame_that_would_turn_more_steeply_is_refused(wild):
    frame = wild[0]
    with pytest.raises(UserError, match="steeply"):
        StickFrame(replace(frame.turning, turn_rad=50 * frame.turning.turn_rad), frame.chain)
    with pytest.raises(UserError, match="stretched"):
        StickFrame(replace(frame.turning, matrix=2 * frame.turning.matrix), frame.chain)


@pytest.fixture
def run(tmp_path, curved_model, arm):
    """A saved model with frames of both its seeds."""
    contexts = np.random.default_rng(0).uniform(-0.5, 0.5, (60, 4))
    decoders = [curved_model.decoder(seed) for seed in range(2)]
    curved_model.save(tmp_path, run={"frame": save_frames(tmp_path, decoders, arm.chain, contexts)})
    return tmp_path


def test_a_kept_frame_is_the_same_to_the_last_bit(run, curved_model, arm):
    contexts = np.random.default_rng(0).uniform(-0.5, 0.5, (60, 4))
    u = np.random.default_rng(1).uniform(-1, 1, (60, 2))
    for seed in range(2):
        fitted = fit_frame(curved_model.decoder(seed), arm.chain, contexts, "facing")
        np.testing.assert_array_equal(
            load_frame(run, seed, "facing", arm.chain)(u, contexts), fitted(u, contexts)
        )


def test_a_person_without_a_profile_drives_in_the_frame_unless_they_ask_for_none(run, arm, curved_model):
    here, u = Context(np.full(4, 0.1), np.empty(0)), np.array([0.6, -0.3])
    z = latent_controller(run, None, arm, "facing").latent(u, here, 0)
    np.testing.assert_array_equal(z, load_frame(run, 0, "facing", arm.chain)(u, here.state))
    assert np.abs(z - u).max() > 0.05
    plain = latent_controller(run, None, arm, None)
    np.testing.assert_array_equal(plain.latent(u, here, 0), u)
    framed = latent_controller(run, None, arm, "facing")
    assert framed.speed_bound(here, 0) == plain.speed_bound(here, 0)


def test_an_older_run_without_a_frame_still_has_z_equal_to_u(run, arm):
    config = json.loads((run / "config.json").read_text())
    del config["frame"]
    (run / "config.json").write_text(json.dumps(config))
    (run / FRAME_NAME).unlink()
    here, u = Context(np.full(4, 0.1), np.empty(0)), np.array([0.6, -0.3])
    np.testing.assert_array_equal(latent_controller(run, None, arm, "facing").latent(u, here, 0), u)


@pytest.mark.parametrize(
    "change", [{"places": 10**9}, {"seeds": 10**9}, {"seeds": 0}, {"sha256": "0"}, {"places": 3}]
)
def test_a_damaged_frame_is_refused(run, arm, change):
    config = json.loads((run / "config.json").read_text())
    config["frame"] |= change
    (run / "config.json").write_text(json.dumps(config))
    with pytest.raises(UserError):
        load_frame(run, 0, "facing", arm.chain)
