import numpy as np

from latentarm.robots.model_file import load_model_file

# Two links that fold onto each other over a short one between, and a hand fixed to the last.
FOLDING = """
<mujoco>
  <worldbody>
    <body name="a"><joint axis="0 1 0" range="-90 90"/>
      <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.4"/>
      <body name="b" pos="0 0 0.45"><joint axis="0 1 0" range="-90 90"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.05"/>
        <body name="c" pos="0 0 0.09"><joint axis="0 1 0" range="-90 90"/>
          <geom type="capsule" size="0.03" fromto="0 0 0.05 0 0 0.4"/>
          <body name="hand" pos="0 0 0.4"><geom size="0.05"/><site name="tool"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  {extra}
</mujoco>
"""


def watched(written, extra=""):
    robot = load_model_file(written(FOLDING.format(extra=extra)))
    return {tuple(sorted(robot.capsules.name[k] for k in pair)) for pair in robot.self_pairs}


def test_links_that_can_meet_are_watched_and_neighbours_are_not(written):
    pairs = watched(written)
    assert ("a", "hand") in pairs
    assert ("a", "c") in pairs
    assert not pairs & {("a", "b"), ("b", "c"), ("b", "hand"), ("c", "hand")}


def test_pairs_that_the_model_excludes_are_not_watched(written):
    pairs = watched(written, '<contact><exclude body1="a" body2="c"/></contact>')
    # What else rides on the same link can still meet.
    assert pairs == {("a", "hand")}


def test_a_capsule_of_several_bodies_is_watched_though_one_of_them_is_excluded(written):
    """More bodies on one link than it has capsules: some are merged, and go by both names."""
    spikes = "".join(
        f'<body name="spike{k}" pos="0 0 0.35"><geom size="0.02" pos="{0.05 * k} 0 0"/></body>'
        for k in range(4)
    )
    text = FOLDING.replace('<body name="hand"', spikes + '<body name="hand"')
    whole = load_model_file(written(text.format(extra="")))
    merged = next(name for name in whole.capsules.name if "+" in name)
    part = merged.split(" + ")[0]
    robot = load_model_file(
        written(text.format(extra=f'<contact><exclude body1="a" body2="{part}"/></contact>'))
    )
    np.testing.assert_array_equal(robot.self_pairs, whole.self_pairs)
    assert any({robot.capsules.name[k] for k in pair} == {"a", merged} for pair in robot.self_pairs)


def test_pairs_that_touch_at_home_are_not_watched(written):
    folded = '<keyframe><key name="home" qpos="0 1.57 1.57"/></keyframe>'
    assert watched(written, folded) == {("a", "c")}


def test_the_same_robot_is_always_read_the_same(written):
    path = written(FOLDING.format(extra=""))
    first, second = load_model_file(path), load_model_file(path)
    np.testing.assert_array_equal(first.self_pairs, second.self_pairs)
    np.testing.assert_array_equal(first.home, second.home)
