"""At most one page drives, and nobody begins or stops driving without a word."""

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from latentarm.web.server.sessions import MOST, Sessions


def test_the_first_page_drives_and_the_next_watches():
    sessions = Sessions()
    ada, bob = sessions.join("Ada"), sessions.join("Bob")
    assert sessions.drives(ada)
    assert not sessions.drives(bob)
    assert sessions.driver.name == "Ada"


def test_driving_is_handed_over_only_to_who_asked():
    sessions = Sessions()
    ada, bob, eve = (sessions.join(name) for name in ("Ada", "Bob", "Eve"))
    assert not sessions.hand_over(ada, bob.id)
    sessions.ask(bob)
    sessions.ask(eve)
    assert sessions.asking == bob
    assert not sessions.hand_over(bob, bob.id)
    assert not sessions.hand_over(ada, eve.id)
    assert sessions.hand_over(ada, bob.id)
    assert sessions.drives(bob)
    assert sessions.asking is None


def test_a_driver_who_goes_leaves_the_arm_to_who_asked_or_to_nobody():
    sessions = Sessions()
    ada, bob = sessions.join("Ada"), sessions.join("Bob")
    assert sessions.leave(ada)
    assert sessions.driver is None
    sessions.ask(bob)
    assert sessions.drives(bob)
    eve = sessions.join("Eve")
    sessions.ask(eve)
    assert sessions.release(bob)
    assert sessions.drives(eve)


def test_there_is_room_for_so_many():
    sessions = Sessions()
    pages = [sessions.join(None) for _ in range(MOST)]
    assert sessions.join("one too many") is None
    assert len({page.id for page in pages}) == MOST
    sessions.leave(pages[3])
    assert sessions.join("now") is not None


class Whoever(RuleBasedStateMachine):
    """Pages come, ask, hand over, give up and go in any order."""

    def __init__(self):
        super().__init__()
        self.sessions = Sessions()
        self.pages = []
        self.turn = self.sessions.turn
        self.driver = None

    @rule()
    def come(self):
        page = self.sessions.join("somebody")
        if page is not None:
            self.pages.append(page)

    @rule(at=st.integers(0, 20), what=st.sampled_from(["ask", "release", "leave"]))
    def do(self, at, what):
        if self.pages:
            page = self.pages[at % len(self.pages)]
            getattr(self.sessions, what)(page)
            if what == "leave":
                self.pages.remove(page)

    @rule(giver=st.integers(0, 20), taker=st.integers(0, 20))
    def hand_over(self, giver, taker):
        if self.pages:
            self.sessions.hand_over(
                self.pages[giver % len(self.pages)], self.pages[taker % len(self.pages)].id
            )

    @invariant()
    def one_drives_at_most_and_every_change_is_a_new_turn(self):
        driving = [page for page in self.pages if self.sessions.drives(page)]
        assert len(driving) <= 1
        assert self.sessions.driver == (driving[0] if driving else None)
        assert self.sessions.asking not in driving or self.sessions.asking is None
        if self.sessions.driver != self.driver:
            assert self.sessions.turn > self.turn
        self.driver, self.turn = self.sessions.driver, self.sessions.turn
        assert self.sessions.count == len(self.pages)


TestWhoever = Whoever.TestCase


def test_guests_are_numbered_from_1_among_those_who_are_there():
    sessions = Sessions()
    first, second = sessions.join(None), sessions.join("")
    assert (first.name, second.name) == (1, 2)
    sessions.release(first)
    sessions.ask(second)
    sessions.leave(first)
    assert [sessions.join(None).name for _ in range(2)] == [1, 3]
