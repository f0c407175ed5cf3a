"""Contexts of named features: the same vector in training and in the control loop, and its errors."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.assistance.controllers.latent import LatentController
from latentarm.control.step import Step
from latentarm.core.context import FEATURES, OBJECT, context_vector, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Context, Pose
from latentarm.demonstrations.contexts import context_layout, episode_contexts
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_WIDTH, told_by
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.models.estimators import MODELS
from latentarm.models.pca.training import PCA
from latentarm.models.scaling import feature_normaliser
from latentarm.models.tool_frame import ToolFrame
from latentarm.robots.kinematics.pose_rows import object_rows, pose_rows, seen_rows, stored_rows
from latentarm.robots.planar import planar
from latentarm.safety.config import SafetyConfig
from latentarm.testing.models import EVERYTHING, JOINTS, OBJECTS, SMALL, demonstrations

ARM = planar(JOINTS)
COMBINATIONS = [
    ("joints", *rest) for count in range(len(FEATURES)) for rest in permutations(FEATURES[1:], count)
]


def four_motions():
    shown = demonstrations()
    return replace(shown, episodes=shown.episodes[:4])


def moment(episode, sample):
    """What the control loop would be told at one sample of an episode, from poses and a reading."""
    things = episode.extras[ENVIRONMENT][sample].reshape(-1, 7)
    poses = {}
    for name, row in zip(OBJECTS, things, strict=True):
        axes = seen_rows(row)[3:].reshape(3, 2)
        poses[name] = Pose(row[:3], np.column_stack([axes, np.cross(axes[:, 0], axes[:, 1])]))
    return Context(
        state=episode.state[sample],
        belief=episode.extras["belief"][sample],
        gripper=episode.extras[GRIPPER_WIDTH][sample],
        objects=object_rows(poses, OBJECTS),
    )


@settings(max_examples=60, deadline=None)
@given(
    features=st.sampled_from(COMBINATIONS),
    sample=st.integers(0, 79),
    lead=st.lists(st.integers(1, 3), max_size=2),
)
def test_the_loop_sees_what_training_saw(features, sample, lead):
    shown = four_motions()
    episode = shown.episodes[0]
    vectors = episode_contexts(episode, features)
    now = moment(episode, sample)
    np.testing.assert_allclose(context_vector(now, features), vectors[sample], atol=1e-15)
    assert context_layout(shown, features).width == vectors.shape[1]
    pairs = make_pairs(shown, 2, 0.0, features, np.random.default_rng(0))
    own = pairs.context[pairs.episode == 0]
    assert (own == vectors[sample]).all(axis=1).any()
    # A planner asks about hypothetical states of the same moment.
    states = np.broadcast_to(now.state, (*lead, JOINTS)) + 0.1
    many = context_vector(replace(now, state=states), features)
    assert many.shape == (*lead, vectors.shape[1])
    np.testing.assert_array_equal(many[..., :JOINTS], states)
    np.testing.assert_allclose(
        many[..., JOINTS:], np.broadcast_to(vectors[sample, JOINTS:], many[..., JOINTS:].shape), atol=1e-15
    )


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_pose_is_the_same_by_its_matrix_and_by_its_quaternion(seed):
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3, 3)))
    turn *= np.linalg.det(turn)[:, None, None]
    pose = Pose(rng.normal(size=(3, 3)), turn)
    stored = stored_rows(pose)
    for scale in (1.0, -1.0, 1.0 + 1e-6):
        again = np.concatenate([stored[:, :3], scale * stored[:, 3:]], axis=1)
        np.testing.assert_allclose(seen_rows(again), pose_rows(pose), atol=1e-12)


def test_earlier_names_are_those_of_features():
    assert feature_names("state") == feature_names(("state",)) == feature_names("joints") == ("joints",)
    assert feature_names("state_belief") == feature_names(["joints", "belief"]) == ("joints", "belief")
    shown = four_motions()
    for name, kind in (("cae", "state_belief"), ("pca", "state")):
        fits = [
            MODELS[name](**SMALL, context=context).fit(shown, chain=ARM.chain)
            for context in (kind, feature_names(kind))
        ]
        for tensor, values in fits[0].trained_.tensors.items():
            np.testing.assert_array_equal(fits[1].trained_.tensors[tensor], values)


@pytest.mark.parametrize(
    ("context", "said"),
    [
        ("mood", "no feature 'mood'; there are: joints, belief"),
        (("joints", "belief", "belief"), "names belief twice"),
        (("objects", "joints"), "begins with the joints"),
        ((), "begins with the joints"),
    ],
)
def test_a_context_that_makes_no_sense_is_refused(context, said):
    with pytest.raises(UserError, match=said):
        feature_names(context)
    with pytest.raises(UserError, match=f"parameter context is .*{said}"):
        PCA(context=context).fit(four_motions())


def test_what_a_dataset_lacks_is_named():
    shown = four_motions()
    for feature, source in (("belief", "belief"), ("gripper", GRIPPER_WIDTH), ("objects", ENVIRONMENT)):
        episodes = tuple(
            replace(one, extras={name: values for name, values in one.extras.items() if name != source})
            for one in shown.episodes
        )
        kept = sorted(set(shown.episodes[0].extras) - {source})
        with pytest.raises(UserError, match=f"Episode 0 has no {source}.* it has {', '.join(kept)}: "):
            PCA(context=("joints", feature)).fit(replace(shown, episodes=episodes))
    with pytest.raises(UserError, match="does not say which things"):
        PCA(context=("joints", "objects")).fit(replace(shown, objects=()))
    with pytest.raises(UserError, match="which arm"):
        PCA(context=("joints", "objects_in_tool")).fit(shown)
    zero = {**shown.episodes[0].extras, ENVIRONMENT: np.zeros((80, 14))}
    with pytest.raises(UserError, match=r"quaternion .* is zero"):
        episode_contexts(replace(shown.episodes[0], extras=zero), EVERYTHING)


def test_a_dataset_keeps_the_names_of_its_things(tmp_path):
    shown = four_motions()
    write_dataset(shown, tmp_path / "data")
    assert read_dataset(tmp_path / "data").objects == OBJECTS
    with pytest.raises(UserError, match="has 14 entries for 1 things"):
        write_dataset(replace(shown, objects=("cup",)), tmp_path / "fewer")
    with pytest.raises(UserError, match="must be distinct"):
        write_dataset(replace(shown, objects=("cup", "cup")), tmp_path / "twice")
    write_dataset(replace(shown, objects=()), tmp_path / "nameless")
    assert read_dataset(tmp_path / "nameless").objects == ()


def test_things_in_the_tools_frame_move_with_the_state():
    """A context holds them in the base frame; what the networks see follows any state."""
    layout = context_layout(four_motions(), ("joints", "objects_in_tool"))
    frame = ToolFrame(ARM.chain, layout)
    rng = np.random.default_rng(0)
    states = rng.uniform(-1, 1, (5, JOINTS))
    tool = ARM.chain.forward(states)
    held = np.concatenate([pose_rows(tool), pose_rows(tool)], axis=1)
    seen = frame.apply(np.concatenate([states, held], axis=1))
    # What the tool holds stands at its origin and is not turned.
    np.testing.assert_allclose(seen[:, JOINTS:], np.tile([0, 0, 0, 1, 0, 0, 1, 0, 0], (5, 2)), atol=1e-12)


def test_each_feature_has_its_own_normaliser():
    shown = four_motions()
    vectors = np.concatenate([episode_contexts(one, EVERYTHING) for one in shown.episodes])
    layout = context_layout(shown, EVERYTHING)
    framed = ToolFrame(ARM.chain, layout).apply(vectors)
    normaliser = feature_normaliser(vectors, framed, layout)
    gripper = normaliser.apply(vectors)[:, layout.columns("gripper")]
    np.testing.assert_allclose([gripper.min(), gripper.max()], [-1, 1])
    for feature in ("objects", "objects_in_tool"):
        things = layout.columns(feature)
        table = slice(things.start + OBJECT, things.stop)
        # The table never moved, so nothing was learned of its place: wherever it stands, nothing follows.
        np.testing.assert_allclose(normaliser.apply(framed + 0.7)[:, table], 0.0, atol=1e-8)
        cup = normaliser.scale[things.start : things.start + 2]
        assert ((cup >= 0.05) & (cup < 1.0)).all()


def test_a_decoder_heeds_a_thing_that_moved_and_no_thing_that_never_did():
    model = MODELS["cae"](**SMALL, context=("joints", "objects")).fit(four_motions())
    context = context_vector(moment(four_motions().episodes[0], 3), ("joints", "objects"))
    cup, table = context.copy(), context.copy()
    cup[JOINTS] += 0.1
    table[JOINTS + OBJECT] += 0.5
    u, decode = np.array([0.5, -0.5]), model.decoder().decode
    assert np.abs(decode(u, cup) - decode(u, context)).max() > 1e-6
    np.testing.assert_allclose(decode(u, table), decode(u, context), atol=1e-8)


def test_a_controller_that_looks_at_things_is_told_where_they_are():
    shown = four_motions()
    features = ("joints", "objects")
    controller = LatentController(PCA(context=features).fit(shown).decoder())
    assert controller.objects == OBJECTS
    with pytest.raises(UserError, match="poses of cup, table, and nothing tells"):
        Step(ARM, controller, SafetyConfig())
    now = moment(shown.episodes[0], 3)
    step = Step(ARM, controller, SafetyConfig(), surroundings=lambda: now.objects)
    told = step.context(now.state)
    np.testing.assert_array_equal(context_vector(told, features), context_vector(now, features))
    with pytest.raises(UserError, match=r"2 things \(cup, table\), and here are .* 0 things"):
        controller.action(np.zeros(2), Context(now.state, now.belief), 0)
    with pytest.raises(UserError, match="looks at 'table', which is not here; there is: cup"):
        object_rows({"cup": Pose(np.zeros(3), np.eye(3))}, OBJECTS)


def test_a_model_that_learned_from_toggles_is_not_driven():
    shown = four_motions()
    toggled = tuple(
        replace(one, extras={"observation.gripper_toggled": one.extras[GRIPPER_WIDTH] > 0.04})
        for one in shown.episodes
    )
    model = PCA(context=("joints", "gripper")).fit(replace(shown, episodes=toggled, objects=()))
    with pytest.raises(UserError, match="which no arm tells: import the recordings again"):
        LatentController(model.decoder())


def test_a_decoder_sees_what_the_gripper_was_told_and_an_earlier_one_what_it_measures():
    """What is held keeps the fingers apart; told to close they are the same for every thing."""
    shown = four_motions()
    told = tuple(
        replace(
            one, extras={**one.extras, ACTION_GRIPPER: np.where(one.extras[GRIPPER_WIDTH] > 0.04, 0.08, 0.0)}
        )
        for one in shown.episodes
    )
    with_commands = replace(shown, episodes=told)
    here = replace(moment(told[0], 3), gripper=np.array([0.05]), gripper_target=np.array([0.0]))
    features = ("joints", "gripper")
    for dataset, source, opening in (
        (with_commands, ACTION_GRIPPER, 0.0),
        (shown, GRIPPER_WIDTH, 0.05),
        (told_by(with_commands, GRIPPER_WIDTH), GRIPPER_WIDTH, 0.05),
    ):
        decoder = MODELS["cae"](**SMALL, context=features).fit(dataset).decoder()
        assert decoder.layout.gripper == source
        contexts = episode_contexts(dataset.episodes[0], features)
        np.testing.assert_array_equal(contexts[:, -1:], dataset.episodes[0].extras[source])
        u = np.array([0.5, -0.5])
        expected = decoder.decode(u, np.append(here.state, opening))
        np.testing.assert_array_equal(LatentController(decoder).action(u, here, 0), expected)
