"""Your own decoder: any function of the input and the context drives the arm, behind the safety filters."""

from typing import final

import numpy as np

import latentarm as la


@final
class BaseAndElbow(la.Controller):
    """The first axis turns the base, the second the elbow; slower where the elbow is bent."""

    modes = ("joints",)
    input_dim = 2

    def latent(self, u, context, mode):
        """Z = u, (..., 2)."""
        return u

    def action(self, z, context, mode):
        """Joint velocities (..., 7), rad/s; the leading axes are the inputs that the belief asks about."""
        slower = 0.5 + 0.5 * np.cos(context.state[..., 3])
        action = np.zeros((*z.shape[:-1], 7))
        action[..., 0], action[..., 3] = 0.4 * z[..., 0], 0.4 * slower * z[..., 1]
        return action


robot = la.load_robot("panda")
clock, step = la.SimulatedClock(), la.Step(robot, BaseAndElbow(), la.SafetyConfig(), dt_s=0.01)
with la.make_arm("kinematic", robot, robot.home, clock.now_s) as arm:
    step.reset(arm.read().q)
    for tick in range(150):
        clock.wait_until(0.01 * tick)
        u = np.array([1.0, 0.5]) if tick else np.zeros(2)
        arm.send(step(la.Input(u), 0.0, arm.read(), clock.now_s()).command)
        if tick == 0:
            arm.enable()
            step.enable()
    print(f"The base turned by {np.degrees(arm.read().q[0] - robot.home[0]):.0f} degrees.")
