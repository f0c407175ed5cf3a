import tracemalloc

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.reader import read
from latentarm.robots.shapes import bounding_capsule, convex_hull_vertices, read_capsules


def distance_to(capsule, points):
    start, end, _ = capsule
    distance, _, _ = segment_distance(points, points, start, end)
    return distance


@given(
    arrays(np.float64, st.tuples(st.integers(1, 12), st.just(3)), elements=st.floats(-1, 1)),
    st.integers(0, 2**32 - 1),
)
def test_a_bounding_capsule_covers_every_ball(centres, seed):
    radii = np.random.default_rng(seed).uniform(0.0, 0.3, size=len(centres))
    capsule = bounding_capsule(centres, radii)
    assert (distance_to(capsule, centres) + radii <= capsule[2] + 1e-9).all()


def test_a_capsule_is_its_own_bounding_capsule():
    start, end = np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.3, 0.7])
    capsule = bounding_capsule(np.stack([start, end]), np.array([0.05, 0.05]))
    assert capsule[2] == pytest.approx(0.05)
    assert {tuple(point.round(9)) for point in capsule[:2]} == {tuple(start), tuple(end)}


def test_memory_grows_with_the_points_and_not_with_their_square():
    points = np.random.default_rng(0).normal(size=(30_000, 3))
    tracemalloc.start()
    bounding_capsule(points, np.zeros(len(points)))
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak_bytes < 50e6


@given(
    arrays(np.float64, st.tuples(st.integers(1, 40), st.just(3)), elements=st.floats(-1, 1)),
    st.sampled_from([(1, 1, 1), (1, 1, 0), (1, 0, 0)]),
)
def test_the_capsule_around_the_hull_covers_every_vertex(points, flatten):
    points = points * flatten
    hull = convex_hull_vertices(points)
    capsule = bounding_capsule(hull, np.zeros(len(hull)))
    assert (distance_to(capsule, points) <= capsule[2] + 1e-9).all()


def test_a_long_box_becomes_a_capsule_along_it():
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.03, 0.03) for z in (-0.04, 0.04)])
    start, end, radius = bounding_capsule(corners, np.zeros(8))
    assert radius == pytest.approx(0.05)
    np.testing.assert_allclose(np.abs(end - start), [1.0, 0, 0], atol=1e-9)


SURFACES = """
<mujoco><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body name="scenery" pos="3 0 0"><geom size="0.3"/></body>
  <body name="arm" pos="0.1 0.2 0.3" euler="10 20 30">
    <joint name="j" axis="0 0 1"/>
    {geom}
    <site name="tip"/>
  </body>
</worldbody></mujoco>
"""


@pytest.mark.parametrize(
    "geom",
    [
        '<geom type="sphere" size="0.2" pos="0.1 0 0"/>',
        '<geom type="capsule" size="0.1 0.3" euler="30 0 0"/>',
        '<geom type="cylinder" size="0.1 0.3" euler="30 0 10"/>',
        '<geom type="box" size="0.1 0.2 0.3" euler="30 50 10" pos="0 0.3 0"/>',
        '<geom type="ellipsoid" size="0.1 0.2 0.3" euler="30 50 10"/>',
    ],
)
def test_every_geom_is_covered(geom):
    model = mujoco.MjModel.from_xml_string(SURFACES.format(geom=geom))
    capsules = read_capsules(model, read(model, ["tip"]))
    assert capsules.name == ("arm",)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inner = model.ngeom - 1
    rng = np.random.default_rng(0)
    # Rays from the geom's centre find its surface; every point of it lies in the capsule.
    for direction in rng.normal(size=(200, 3)):
        direction /= np.linalg.norm(direction)
        far = data.geom_xpos[inner] + 2.0 * direction
        hit = np.zeros(1, dtype=np.int32)
        distance = mujoco.mj_ray(model, data, far, -direction, None, 1, -1, hit)
        if hit[0] != inner:
            continue
        point = far - distance * direction
        local = data.body("arm").xmat.reshape(3, 3).T @ (point - data.body("arm").xpos)
        gap = distance_to((capsules.start[0], capsules.end[0], 0.0), local[None])[0]
        assert gap <= capsules.radius[0] + 1e-6


def test_the_capsules_cover_the_meshes_of_a_real_arm(ur5e_file):
    robot = load_robot(str(ur5e_file))
    model = robot.model()
    reading = read(model, [tool.name for tool in robot.chain.tools])
    for geom in range(model.ngeom):
        if model.geom_type[geom] != int(mujoco.mjtGeom.mjGEOM_MESH):
            continue
        mesh = model.geom_dataid[geom]
        vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        rotation = np.empty(9)
        mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
        body = model.geom_bodyid[geom]
        placed = vertices @ rotation.reshape(3, 3).T + model.geom_pos[geom]
        to_link = reading.body_transform[body]
        placed = placed @ to_link[:3, :3].T + to_link[:3, 3]
        mine = np.flatnonzero(robot.capsules.link == reading.body_link[body])
        inside = [
            distance_to((robot.capsules.start[k], robot.capsules.end[k], 0.0), placed)
            <= robot.capsules.radius[k] + 1e-6
            for k in mine
        ]
        assert np.any(inside, axis=0).all()


def test_visual_geoms_count_only_where_nothing_collides():
    visual = '<geom size="0.5" contype="0" conaffinity="0"/>'
    for geom, radius in ((visual + '<geom size="0.1"/>', 0.1), (visual, 0.5)):
        model = mujoco.MjModel.from_xml_string(SURFACES.format(geom=geom))
        np.testing.assert_allclose(read_capsules(model, read(model, ["tip"])).radius, radius)


def test_many_geoms_are_merged_into_few_that_cover_them():
    rng = np.random.default_rng(0)
    centres = rng.uniform(-0.3, 0.3, size=(9, 3))
    geoms = "".join(f'<geom size="0.05" pos="{x} {y} {z}"/>' for x, y, z in centres)
    model = mujoco.MjModel.from_xml_string(SURFACES.format(geom=geoms))
    capsules = read_capsules(model, read(model, ["tip"]))
    assert len(capsules) == 2
    covered = [
        distance_to((capsules.start[k], capsules.end[k], 0.0), centres) + 0.05 <= capsules.radius[k] + 1e-6
        for k in (0, 1)
    ]
    assert np.any(covered, axis=0).all()
