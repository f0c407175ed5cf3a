"""Checks of what every study is asked for."""

from collections.abc import Collection

from latentarm.errors import UserError


def check_tasks(tasks: Collection[str], known: Collection[str]) -> None:
    """Refuse tasks that a study does not have.

    Args:
        tasks: what was asked for.
        known: what there is.

    Raises:
        UserError: there are no tasks, or one is unknown or named twice.
    """
    names = ", ".join(known)
    for task in tasks:
        if task not in known:
            raise UserError(f"There is no task {task!r}: choose from {names}.")
    if not tasks or len(set(tasks)) < len(tasks):
        raise UserError(f"Name at least one task, and none twice: choose from {names}.")
