"""People who wait for an arm get one in turn, and hear how long it takes."""

from hypothesis import given
from hypothesis import strategies as st

from latentarm_research.user_studies.serving.queue import GONE_S, Queue

LIMIT_S = 20.0


class Clock:
    time_s = 0.0

    def now_s(self) -> float:
        return self.time_s


def test_the_time_is_that_of_those_who_drive_and_of_those_before() -> None:
    queue = Queue(2)
    asked = [queue.waits_s(key, LIMIT_S, [30.0, 45.0]) for key in "abcd"]
    assert asked == [30.0, 45.0, 50.0, 65.0]
    # Asking again changes nothing.
    assert queue.waits_s("b", LIMIT_S, [30.0, 45.0]) == 45.0


def test_nobody_overtakes_the_first() -> None:
    queue = Queue(1)
    assert queue.waits_s("a", LIMIT_S, [5.0]) == 5.0
    assert queue.waits_s("b", LIMIT_S, []) == LIMIT_S
    assert queue.waits_s("a", LIMIT_S, []) == 0.0
    # Somebody who has had an arm is the last of those who wait.
    assert queue.waits_s("a", LIMIT_S, [5.0]) == 5.0 + LIMIT_S


def test_somebody_who_no_longer_asks_is_not_waited_for() -> None:
    clock = Clock()
    queue = Queue(1, clock.now_s)
    queue.waits_s("a", LIMIT_S, [5.0])
    queue.waits_s("b", LIMIT_S, [5.0])
    clock.time_s = GONE_S
    assert queue.waits_s("b", LIMIT_S, []) == 0.0


@given(st.integers(1, 4), st.integers(1, 8), st.lists(st.booleans(), min_size=50, max_size=50))
def test_everybody_drives_in_turn_and_never_more_than_there_are_arms(
    arms: int, people: int, ends: list[bool]
) -> None:
    queue, driving, served = Queue(arms), list[int](), list[int]()
    for end in ends:
        for person in range(people):
            if person not in driving and not queue.waits_s(str(person), LIMIT_S, [1.0] * len(driving)):
                driving.append(person)
                served.append(person)
        assert len(driving) == min(arms, people)
        if end:
            driving.pop(0)
    times = [served.count(person) for person in range(people)]
    assert max(times) - min(times) <= 1
