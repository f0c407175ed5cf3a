"""What the tests of a study's hypotheses come to, in words."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar


class Tested(Protocol):
    """One test of one hypothesis."""

    @property
    def hypothesis(self) -> str:
        """``H1``, ``H2``, ..."""
        ...

    @property
    def task(self) -> str:
        """On which task."""
        ...

    @property
    def holds(self) -> bool:
        """Whether it came out as the hypothesis says."""
        ...


Test = TypeVar("Test", bound=Tested)
About = TypeVar("About")


@dataclass(frozen=True)
class Verdict(Generic[About]):
    """What the tests say of one hypothesis.

    Attributes:
        hypothesis: ``H1``, ``H2``, ...
        about: what else the family of tests shares, such as the model.
        supported: whether every comparison holds.
        by_task: task -> ``supported`` or ``not supported: why``, in the tasks' order.
    """

    hypothesis: str
    about: About
    supported: bool
    by_task: Mapping[str, str]


def verdicts(
    tests: Sequence[Test], about: Callable[[Test], About], why_not: Callable[[Sequence[Test]], str]
) -> list[Verdict[About]]:
    """One verdict for each family of tests, in their order; a task supports where all its tests do.

    Args:
        tests: all of a study's.
        about: which tests of a hypothesis are one family.
        why_not: what is said of a task's tests, of which at least one does not hold.
    """
    families: dict[tuple[str, About], list[Test]] = {}
    for one in tests:
        families.setdefault((one.hypothesis, about(one)), []).append(one)
    return [
        Verdict(
            hypothesis=hypothesis,
            about=shared,
            supported=all(one.holds for one in family),
            by_task={
                task: _said([one for one in family if one.task == task], why_not)
                for task in dict.fromkeys(one.task for one in family)
            },
        )
        for (hypothesis, shared), family in families.items()
    ]


def _said(tests: Sequence[Test], why_not: Callable[[Sequence[Test]], str]) -> str:
    return "supported" if all(one.holds for one in tests) else f"not supported: {why_not(tests)}"
