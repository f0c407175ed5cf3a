"""What a recording says of what is driven."""

from latentarm.control.recorder import EpisodeHeader
from latentarm.demonstrations.provenance import provenance_now
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup
from latentarm.web.protocol.orders import ModeName


def episode_header(
    setup: DriveSetup, things: tuple[str, ...], mode: ModeName, task: str, person: str
) -> EpisodeHeader:
    """The header of an episode that begins now.

    Args:
        setup: what is driven.
        things: names of those whose poses are recorded.
        mode: how the arm is steered.
        task: what is done, in words.
        person: who drives; "" where that is unknown.
    """
    robot, spec = setup.task.robot, setup.spec
    return EpisodeHeader(
        robot=robot.name,
        joint_names=robot.joint_names,
        joint_limits=robot.limits,
        rate_hz=1.0 / PERIOD_S,
        task=task,
        goals=setup.task.goals,
        modes=setup.controller.modes,
        provenance=provenance_now(
            person=person,
            run="" if spec.run is None else spec.run.name,
            run_fingerprint=setup.run_fingerprint,
            profile=spec.profile or "",
            controller=mode,
        ),
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
        things=things,
        objects=setup.objects if things else (),
    )
