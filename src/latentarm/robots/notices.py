"""Notices about a robot, shown before it moves."""

from collections.abc import Sequence

from latentarm.robots.robot import Robot


def assumed_limits(robot: Robot) -> str:
    """Assumed limits in words, such as "acceleration and jerk of all joints"; "" without any."""
    joints: dict[tuple[int, ...], list[str]] = {}
    for quantity, indices in robot.limits.assumed.items():
        joints.setdefault(indices, []).append(quantity)
    parts = [f"{_listed(names)} of {_joints(robot, indices)}" for indices, names in joints.items()]
    if robot.tool_speed_source == "assumed":
        parts.append("largest speed of the tool")
    return "; ".join(parts)


def notices(robot: Robot) -> list[str]:
    """Notices for the person who is about to drive or record a robot."""
    said: list[str] = []
    tool = robot.chain.tools[0].name
    if robot.still_joints:
        total = robot.dof - len(robot.driven_fingers) + len(robot.still_joints)
        still = ", ".join(robot.still_joints)
        said.append(
            f"{total - len(robot.still_joints)} of {total} joints move {tool}; these stay still: {still}."
        )
    if robot.driven_fingers:
        said.append(
            f"{_listed(robot.driven_fingers)} looks like a gripper's joint and is driven as one of the arm's."
        )
    assumed = assumed_limits(robot)
    if assumed:
        said.append(f"Assumed limits of {robot.name}: {assumed}. State the real ones with --limits FILE.")
    if not len(robot.capsules):
        said.append(
            f"The model of {robot.name} has no shape: neither collisions with itself nor with obstacles are"
            " watched for."
        )
    if robot.gripper is not None and not robot.gripper.joints:
        said.append(
            f"The model of {robot.name} lacks the gripper, so the safety filters do not know of it: make"
            " obstacles and zones larger by its length."
        )
    return said


def _joints(robot: Robot, indices: Sequence[int]) -> str:
    if len(indices) == robot.dof:
        return "all joints"
    names = [robot.joint_names[joint] for joint in indices]
    return f"joint{'s' if len(names) > 1 else ''} {_listed(names)}"


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
