import numpy as np
import torch

from latentarm.robots.kinematics.torch_chain import TorchChain


def configurations(robot, count):
    return np.random.default_rng(2).uniform(robot.limits.lower, robot.limits.upper, size=(count, robot.dof))


def test_torch_gives_what_numpy_gives(robot):
    q = configurations(robot, 12).reshape(3, 4, robot.dof)
    for tool in range(len(robot.chain.tools)):
        chain = TorchChain(robot.chain, tool)
        position, rotation = chain(torch.from_numpy(q))
        pose = robot.chain.forward(q, tool)
        np.testing.assert_allclose(position.numpy(), pose.position, rtol=0, atol=1e-12)
        np.testing.assert_allclose(rotation.numpy(), pose.rotation, rtol=0, atol=1e-12)
        jacobian = chain.jacobian(torch.from_numpy(q)).numpy()
        np.testing.assert_allclose(jacobian, robot.chain.jacobian(q, tool), rtol=0, atol=1e-12)


def test_gradient_is_the_jacobian(robot):
    q = torch.from_numpy(configurations(robot, 1)[0])
    for tool in range(len(robot.chain.tools)):
        chain = TorchChain(robot.chain, tool)
        expected = robot.chain.jacobian(q.numpy(), tool)
        linear = torch.autograd.functional.jacobian(lambda x, chain=chain: chain(x)[0], q)
        np.testing.assert_allclose(linear.numpy(), expected[:3], rtol=0, atol=1e-12)
        turned = torch.autograd.functional.jacobian(lambda x, chain=chain: chain(x)[1], q)
        rotation = robot.chain.forward(q.numpy(), tool).rotation
        for joint in range(robot.dof):
            # dR/dq Rᵀ is the skew matrix of the angular velocity.
            skew = turned[..., joint].numpy() @ rotation.T
            angular = [skew[2, 1], skew[0, 2], skew[1, 0]]
            np.testing.assert_allclose(angular, expected[3:, joint], rtol=0, atol=1e-12)


def test_single_precision_follows_the_module(robot):
    chain = TorchChain(robot.chain).to(torch.float32)
    q = configurations(robot, 5)
    position, _ = chain(torch.from_numpy(q).to(torch.float32))
    assert position.dtype == torch.float32
    np.testing.assert_allclose(position.numpy(), robot.chain.forward(q).position, rtol=0, atol=1e-5)
