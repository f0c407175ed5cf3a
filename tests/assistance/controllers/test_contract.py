import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from latentarm.assistance.controllers.axis_modes import TWO_STICKS
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm_research.baselines.learned_orientation import LearnedOrientationController, OrientationMap
from latentarm_research.baselines.retargeting import RetargetingController

BELIEF = np.array([0.5, 0.3, 0.2])


@pytest.fixture(
    params=["state_decoder", "belief_decoder", "panda", "planar", "two_sticks", "retargeting", "oriented"]
)
def steered(request, panda):
    """A controller and its robot."""
    if request.param.endswith("decoder"):
        return LatentController(request.getfixturevalue(request.param)), panda
    if request.param == "two_sticks":
        return EndEffectorController(panda, modes=TWO_STICKS), panda
    if request.param == "retargeting":
        return RetargetingController(panda), panda
    if request.param == "oriented":
        layer = np.eye(3, 6), np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        return LearnedOrientationController(panda, OrientationMap((), False, (layer,))), panda
    robot = panda if request.param == "panda" else load_robot("planar")
    return EndEffectorController(robot), robot


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_batch_of_inputs_is_steered_as_each_alone(steered, data):
    controller, robot = steered
    u = data.draw(hnp.arrays(float, (2, 3, controller.input_dim), elements=st.floats(-1, 1)))
    share = data.draw(hnp.arrays(float, robot.dof, elements=st.floats(0, 1)))
    limits = robot.limits
    context = Context(limits.lower + share * (limits.upper - limits.lower), BELIEF)
    for mode in range(len(controller.modes)):
        z = controller.latent(u, context, mode)
        action = controller.action(z, context, mode)
        assert z.shape == u.shape
        assert action.shape == (2, 3, robot.dof)
        assert np.isfinite(action).all()
        alone = controller.action(controller.latent(u[1, 2], context, mode), context, mode)
        assert alone == pytest.approx(action[1, 2], abs=1e-12)


def test_the_modes_have_names(steered):
    controller, _ = steered
    assert len(set(controller.modes)) == len(controller.modes) >= 1
    assert all(controller.modes)


def test_steering_leaves_the_context_alone(steered):
    controller, robot = steered
    context = Context(robot.home.copy(), BELIEF.copy())
    controller.action(np.ones(controller.input_dim), context, 0)
    assert np.array_equal(context.state, robot.home)
    assert np.array_equal(context.belief, BELIEF)


def test_imagined_states_are_steered_as_each_alone(steered):
    controller, robot = steered
    rng = np.random.default_rng(0)
    u = rng.uniform(-1, 1, (3, 4, controller.input_dim))
    states = rng.uniform(robot.limits.lower, robot.limits.upper, (3, 4, robot.dof))
    for mode in range(len(controller.modes)):
        here = Context(states, BELIEF)
        action = controller.action(controller.latent(u, here, mode), here, mode)
        alone = Context(states[1, 2], BELIEF)
        assert action[1, 2] == pytest.approx(
            controller.action(controller.latent(u[1, 2], alone, mode), alone, mode), abs=1e-12
        )
