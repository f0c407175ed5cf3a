from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import Input
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import Bounds
from latentarm.safety.zones_file import read_zones
from stepping import stepped

EXAMPLE = Path(__file__).parents[2] / "docs" / "your-arm" / "zones.toml"
TABLE = """
[keep_out.table]
shape = "half_space"
point_m = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
"""
FACE = """
[zones.face]
shape = "sphere"
centre_m = [0.6, 0.0, 0.55]
radius_m = 0.15
speed_m_per_s = 0.05
"""
OUT = """
[keep_out.pillar]
shape = "sphere"
centre_m = [0.6, 0.5, 0.55]
radius_m = 0.1
"""
MUG = """
[gripped.mug]
centre_m = [0.0, 0.0, 0.1]
size_m = [0.03, 0.02, 0.3]
turned_deg = [0, 0, 90]
"""


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "zones.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_the_file_of_the_docs_holds_for_a_panda(arm):
    stated = read_zones(EXAMPLE)
    zones = stated.slow
    assert [(zone.name, zone.speed) for zone in zones] == [("face", 0.05), ("table", 0.1), ("self", 0.08)]
    face, table, person = (zone.shape for zone in zones)
    assert (type(face), type(table), type(person)) == (Sphere, Box, Capsule)
    np.testing.assert_allclose(table.half_extents, [0.3, 0.6, 0.06])
    assert Bounds(SafetyConfig(zones=zones), arm, 0.01).config.zones == zones
    (table_top,) = stated.keep_out
    assert (table_top.name, type(table_top)) == ("table", HalfSpace)
    assert SafetyConfig(obstacles=stated.keep_out).obstacles[0].normal.tolist() == [0.0, 0.0, 1.0]


def test_a_box_may_be_turned_and_a_half_space_needs_a_direction_only(written):
    box, wall = read_zones(
        written("""
        [zones."Stuhl 1"]
        shape = "box"
        centre_m = [0, 0, 1]
        size_m = [2, 1, 1]
        turned_deg = [90, 20, -70]
        speed_m_per_s = 0.1
        [zones.wall]
        shape = "half_space"
        point_m = [1, 0, 0]
        normal = [-2, 0, 0]
        speed_m_per_s = 0.1
        """)
    ).slow
    assert box.name == "Stuhl 1"
    turned = Rotation.from_euler("xyz", [90, 20, -70], degrees=True)
    np.testing.assert_allclose(box.shape.rotation, turned.as_matrix(), atol=1e-12)
    assert isinstance(wall.shape, HalfSpace)
    np.testing.assert_allclose(wall.shape.normal, [-1.0, 0.0, 0.0])


def test_what_the_gripper_holds_is_a_box(written):
    (mug,) = read_zones(written(MUG)).gripped
    assert mug.name == "mug"
    np.testing.assert_allclose(mug.half_extents, [0.015, 0.01, 0.15])
    np.testing.assert_allclose(mug.rotation @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "states no zones: begin one with [zones.face] or [keep_out.table]"),
        ("[zones.face", "cannot be read as TOML"),
        (FACE + FACE, "cannot be read as TOML"),
        (FACE + FACE.replace("face", "Face"), "Two zones are called 'Face'"),
        ("[zone.face]", "there is no key zone; use zones, keep_out, gripped"),
        (OUT + "speed_m_per_s = 0.1", "there is no key keep_out.pillar.speed_m_per_s; use shape, centre_m"),
        (
            OUT.replace("radius_m = 0.1", ""),
            "keep_out.pillar lacks radius_m: a sphere needs centre_m, radius_m.",
        ),
        (OUT.replace("0.1", "-1"), "The obstacle 'pillar' has radius -1.0"),
        (OUT.replace("pillar", '"a,b"'), "The obstacle 'a,b' needs another name"),
        ("".join(OUT.replace("pillar", f"p{one}") for one in range(9)), "There are 9 solids to keep out of"),
        ("zones = 3", "zones must be a table of names"),
        (MUG.replace("size_m", "radius_m"), "there is no key gripped.mug.radius_m; use shape, centre_m"),
        (MUG + MUG.replace("mug", "cup"), "states 2 things in the gripper: state one that is as large"),
        (FACE.replace("sphere", "ball"), "zones.face.shape must be one of sphere, capsule, box, half_space"),
        (FACE.replace('"sphere"', "1"), "zones.face.shape must be one of"),
        (FACE.replace("radius_m = 0.15", ""), "zones.face lacks radius_m: a sphere needs centre_m, radius_m"),
        (FACE.replace("speed_m_per_s = 0.05", ""), "zones.face lacks speed_m_per_s"),
        (FACE + "size_m = [1, 1, 1]", "there is no key zones.face.size_m; use shape, centre_m, radius_m"),
        (FACE.replace("0.55]", "nan]"), "zones.face.centre_m must be a finite number, not 'nan'"),
        (FACE.replace("0.55]", "0.55, 1]"), "zones.face.centre_m must be three numbers"),
        (FACE.replace("0.15", "inf"), "zones.face.radius_m must be a finite number"),
        (FACE.replace("0.15", "0"), "The zone 'face' has radius 0.0"),
        (FACE.replace("0.6", "600"), "The zone 'face' has its centre over 10 m away: give metres"),
        (TABLE.replace("0.0]", "-20.0]", 1), "The obstacle 'table' has its point over 10 m away"),
        (TABLE.replace("1.0]", "-1.0]"), "'table' holds the arm itself: its normal must point out"),
        (FACE.replace("0.05", "0.001"), "The zone 'face' allows 0.001 m/s: it must be at least 0.01"),
        (FACE.replace("0.05", '"slow"'), "zones.face.speed_m_per_s must be a finite number, not 'slow'"),
        (FACE.replace("zones.face", 'zones."a,b"'), "needs another name"),
        (FACE.replace("zones.face", 'zones."\\u0007"'), "cannot be shown"),
        (
            '[zones.wall]\nshape = "half_space"\npoint_m = [0, 0, 0]\nnormal = [0, 0, 0]\n'
            "speed_m_per_s = 0.1",
            "The zone 'wall' has a normal of length 0",
        ),
    ],
)
def test_what_cannot_be_used_is_one_sentence_that_names_the_file(written, text, said):
    path = written(text)
    with pytest.raises(UserError) as refused:
        read_zones(path)
    assert said in str(refused.value)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there_is_said(tmp_path):
    with pytest.raises(UserError, match=r"nowhere\.toml"):
        read_zones(tmp_path / "nowhere.toml")


SOLIDS = {
    "half_space": "point_m = [0.0, 0.0, 0.1]\nnormal = [0.0, 0.0, 2.0]",
    "sphere": "centre_m = [0.4, 0.0, 0.0]\nradius_m = 0.1",
    "capsule": "start_m = [0.2, 0.0, 0.0]\nend_m = [0.6, 0.0, 0.0]\nradius_m = 0.1",
    "box": "centre_m = [0.4, 0.0, 0.0]\nsize_m = [0.2, 0.2, 0.2]",
}


@pytest.mark.parametrize("shape", SOLIDS)
def test_a_solid_keeps_the_arm_off_by_what_it_states(arm, scripted, written, shape):
    """A hand is thicker than what is kept without it."""
    (solid,) = read_zones(
        written(f'[keep_out.table]\nshape = "{shape}"\n{SOLIDS[shape]}\nclearance_m = 0.08')
    ).keep_out
    controller = EndEffectorController(arm)
    step, state = Step(arm, controller, SafetyConfig(obstacles=(solid,))), arm.home
    step.reset(state)
    step.choose_mode(1)
    for tick in range(300):
        u = np.array([-1.0 if tick else 0.0, 0.0])
        record = stepped(step, Input(u), 0.0, state, 0.01 * tick)
        state = state + 0.01 * record.command.velocity
        if not tick:
            assert step.enable() is None
    tool_m, began_m = (arm.chain.forward(q).position for q in (state, arm.home))
    # It came as near as it may and no nearer: down to the others, round the ball.
    left_m = np.linalg.norm(tool_m - [0.4, 0.0, 0.0]) if shape == "sphere" else tool_m[2]
    assert began_m[2] > 0.3
    assert left_m > 0.1 + 0.08 - 1e-3


@pytest.mark.parametrize("clearance", ["0.01", "-0.1", "0.6", "nan", "inf", "true", '"far"', "[0.1]"])
def test_a_clearance_that_is_none_is_refused(written, clearance):
    with pytest.raises(UserError, match=r"keep_out\.pillar\.clearance_m"):
        read_zones(written(OUT + f"clearance_m = {clearance}"))
